use std::fmt::Write;

use super::Histogram;

/// Numbers as Prometheus reads them, in its text format 0.0.4.
///
/// Every family has its help and its type before its samples, and comes once.
#[derive(Default)]
pub(crate) struct Exposition(String);

/// Names and values of labels.
pub(crate) type Labels<'a> = &'a [(&'a str, &'a str)];

/// Samples of one name.
pub(crate) struct Family<'a> {
    text: &'a mut String,
    name: &'static str,
}

impl Exposition {
    /// What only rises. The name ends in `_total`.
    pub(crate) fn counter(&mut self, name: &'static str, help: &str) -> Family<'_> {
        debug_assert!(name.ends_with("_total"), "{name}");
        self.family(name, "counter", help)
    }

    /// What rises and falls.
    pub(crate) fn gauge(&mut self, name: &'static str, help: &str) -> Family<'_> {
        self.family(name, "gauge", help)
    }

    /// Durations in seconds. The name ends in `_seconds`.
    pub(crate) fn histogram(&mut self, name: &'static str, help: &str) -> Family<'_> {
        debug_assert!(name.ends_with("_seconds"), "{name}");
        self.family(name, "histogram", help)
    }

    /// The whole text.
    pub(crate) fn into_text(self) -> String {
        self.0
    }

    fn family(&mut self, name: &'static str, kind: &str, help: &str) -> Family<'_> {
        debug_assert!(is_name(name), "{name}");
        debug_assert!(!self.0.contains(&format!("# TYPE {name} ")), "{name} twice");
        let text = &mut self.0;
        write(
            text,
            format_args!("# HELP {name} {help}\n# TYPE {name} {kind}\n"),
        );
        Family { text, name }
    }
}

impl Family<'_> {
    /// A whole number.
    pub(crate) fn count(&mut self, labels: Labels<'_>, value: u64) -> &mut Self {
        self.sample("", labels, None, format_args!("{value}"))
    }

    /// Any number.
    pub(crate) fn value(&mut self, labels: Labels<'_>, value: f64) -> &mut Self {
        match value {
            f64::INFINITY => self.sample("", labels, None, format_args!("+Inf")),
            f64::NEG_INFINITY => self.sample("", labels, None, format_args!("-Inf")),
            value => self.sample("", labels, None, format_args!("{value}")),
        }
    }

    /// Yes or no, as 1 or 0.
    pub(crate) fn flag(&mut self, labels: Labels<'_>, is: bool) -> &mut Self {
        self.count(labels, u64::from(is))
    }

    /// Durations.
    pub(crate) fn durations(&mut self, labels: Labels<'_>, histogram: &Histogram) -> &mut Self {
        // Read once: what is added meanwhile is for the next time.
        let counts = histogram.cumulative();
        let bounds = Histogram::BOUNDS.iter().map(|&(_, bound)| bound);
        for (bound, count) in bounds.chain(["+Inf"]).zip(counts) {
            self.sample("_bucket", labels, Some(bound), format_args!("{count}"));
        }
        let (sum, count) = (histogram.sum_s(), counts[counts.len() - 1]);
        self.sample("_sum", labels, None, format_args!("{sum}"));
        self.sample("_count", labels, None, format_args!("{count}"))
    }

    fn sample(
        &mut self,
        suffix: &str,
        labels: Labels<'_>,
        bound: Option<&str>,
        value: std::fmt::Arguments<'_>,
    ) -> &mut Self {
        write(self.text, format_args!("{}{suffix}", self.name));
        let bound = bound.map(|bound| ("le", bound));
        let mut separator = '{';
        for (name, value) in labels.iter().copied().chain(bound) {
            debug_assert!(is_name(name), "{name}");
            let value = escaped(value);
            write(self.text, format_args!("{separator}{name}=\"{value}\""));
            separator = ',';
        }
        if separator == ',' {
            self.text.push('}');
        }
        write(self.text, format_args!(" {value}\n"));
        self
    }
}

fn write(text: &mut String, what: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(what);
}

fn escaped(value: &str) -> String {
    value
        .replace('\\', "\\\\")
        .replace('"', "\\\"")
        .replace('\n', "\\n")
}

fn is_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters
        .next()
        .is_some_and(|first| first.is_ascii_lowercase())
        && characters.all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_written_as_prometheus_reads_them() {
        let mut text = Exposition::default();
        text.counter("lie_tiles_total", "Tiles.")
            .count(&[], u64::MAX);
        text.gauge("lie_error", "Error.")
            .value(&[("of", "a \"b\"\\\n")], 0.25)
            .value(&[("of", "c"), ("at", "d")], f64::INFINITY)
            .flag(&[], true);
        let expected = "# HELP lie_tiles_total Tiles.\n\
                        # TYPE lie_tiles_total counter\n\
                        lie_tiles_total 18446744073709551615\n\
                        # HELP lie_error Error.\n\
                        # TYPE lie_error gauge\n\
                        lie_error{of=\"a \\\"b\\\"\\\\\\n\"} 0.25\n\
                        lie_error{of=\"c\",at=\"d\"} +Inf\n\
                        lie_error 1\n";
        assert_eq!(text.into_text(), expected);
    }

    #[test]
    fn a_histogram_has_a_bucket_for_every_bound_and_one_for_all() {
        let histogram = Histogram::default();
        histogram.observe_ns(2_000_000);
        let mut text = Exposition::default();
        text.histogram("lie_stage_seconds", "Time.")
            .durations(&[("stage", "pack")], &histogram);
        let text = text.into_text();
        for line in [
            "lie_stage_seconds_bucket{stage=\"pack\",le=\"0.001\"} 0\n",
            "lie_stage_seconds_bucket{stage=\"pack\",le=\"0.0025\"} 1\n",
            "lie_stage_seconds_bucket{stage=\"pack\",le=\"+Inf\"} 1\n",
            "lie_stage_seconds_sum{stage=\"pack\"} 0.002\n",
            "lie_stage_seconds_count{stage=\"pack\"} 1\n",
        ] {
            assert!(text.contains(line), "no {line} in {text}");
        }
    }
}
