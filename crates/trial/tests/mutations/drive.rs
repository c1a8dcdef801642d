use std::{
    fmt,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use lie_trial::{Dice, TARGETS, Target, mutated};

use crate::{MEMORY, watch::Watch};

/// What is more does not tell more.
const MOST_FAILURES: usize = 10;
/// How often a long course says how far it is.
const NEWS: Duration = Duration::from_secs(60);

/// Cases to run.
pub(crate) struct Course {
    seed: u64,
    cases: std::ops::Range<u64>,
}

impl Course {
    pub(crate) fn new(seed: u64, count: u64) -> Self {
        Self {
            seed,
            cases: 0..count,
        }
    }

    pub(crate) fn one(seed: u64, case: u64) -> Self {
        Self {
            seed,
            cases: case..case + 1,
        }
    }
}

/// What went wrong.
#[derive(Debug, PartialEq)]
pub(crate) struct Failure {
    pub(crate) case: u64,
    pub(crate) what: String,
    /// The input.
    pub(crate) file: PathBuf,
}

/// How it went.
pub(crate) struct Report {
    target: &'static str,
    seed: u64,
    pub(crate) cases: u64,
    /// Those in which something was taken for good.
    pub(crate) taken: u64,
    took: Duration,
    /// Memory that a case took at most, and its number.
    most: (usize, u64),
    /// The longest case, and its number.
    longest: (Duration, u64),
    pub(crate) failures: Vec<Failure>,
}

pub(crate) fn target(name: &str) -> Target {
    let mut all = TARGETS.into_iter();
    all.find(|target| target.name == name).expect("a target")
}

/// Memory is counted for the whole process: tests run one after the other.
pub(crate) fn turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is held at once while this runs, at most, beyond what was before.
pub(crate) fn most_memory(run: impl FnOnce()) -> usize {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    run();
    MEMORY.peak_usage().saturating_sub(before)
}

/// Runs a course, up to a few failures.
pub(crate) fn drive(target: &Target, course: &Course) -> Report {
    let _turn = turn();
    let seeds = (target.seeds)();
    let mut run = (target.open)();
    // Whatever is set up at its first use belongs to no case.
    for (number, seed) in seeds.iter().enumerate() {
        assert!(run(seed), "seed {number} of {} is not good", target.name);
    }
    let watch = Watch::start(target.name, course.seed);
    let (started, mut told) = (Instant::now(), Instant::now());
    let mut report = Report {
        target: target.name,
        seed: course.seed,
        cases: 0,
        taken: 0,
        took: Duration::ZERO,
        most: (0, 0),
        longest: (Duration::ZERO, 0),
        failures: vec![],
    };
    for case in course.cases.clone() {
        let mut dice = Dice::new(course.seed, case);
        let input = mutated(target.form, &seeds, &mut dice);
        watch.begins(case);
        let (clock, mut outcome) = (Instant::now(), Ok(false));
        let most = most_memory(|| outcome = catch_unwind(AssertUnwindSafe(|| run(&input))));
        report.cases += 1;
        report.longest = report.longest.max((clock.elapsed(), case));
        report.most = report.most.max((most, case));
        let limit = target.memory.of(input.len());
        let what = match outcome {
            Err(panic) => Some(format!("panics: {}", message(&*panic))),
            Ok(_) if most > limit => Some(format!(
                "takes {most} bytes of memory, its limit is {limit}"
            )),
            Ok(is_taken) => {
                report.taken += u64::from(is_taken);
                None
            }
        };
        if let Some(what) = what {
            let file = kept(target, course.seed, case, &input);
            report.failures.push(Failure { case, what, file });
            // What a panic left behind half done is nothing to go on with.
            run = (target.open)();
        }
        if report.failures.len() == MOST_FAILURES {
            break;
        }
        if told.elapsed() > NEWS {
            told = Instant::now();
            println!("{}: {} cases", target.name, report.cases);
        }
    }
    report.took = started.elapsed();
    report
}

fn message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("without a word").to_owned()
}

/// Writes an input to where it can be looked at.
fn kept(target: &Target, seed: u64, case: u64, input: &[u8]) -> PathBuf {
    let folder = std::env::temp_dir().join("lie-mutations");
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join(format!("{}-{seed}-{case}", target.name));
    std::fs::write(&file, input).unwrap();
    file
}

impl fmt::Display for Report {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seed, cases, taken, took) = (self.seed, self.cases, self.taken, self.took);
        let (most, greediest) = self.most;
        let (longest, slowest) = self.longest;
        write!(
            formatter,
            "{}: {cases} cases of seed {seed}, {taken} of them taken, in {took:.1?}; at most {:.2} MiB (case {greediest}) \
             and {longest:.1?} (case {slowest}); {} failures",
            self.target,
            most as f64 / f64::from(1 << 20),
            self.failures.len()
        )
    }
}
