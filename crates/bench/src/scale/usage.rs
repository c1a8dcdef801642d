use lie_protocol::FarmStatus;

use super::Used;

/// What has been used up to some moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Usage {
    /// Seconds of processors by the client; none where that cannot be known.
    pub client_cpu_s: Option<f64>,
    /// The same of the constructor.
    pub constructor_cpu_s: Option<f64>,
    /// The same of the process that simulates the shaders.
    pub shaders_cpu_s: Option<f64>,
    /// How the farm is, if its constructor says so.
    pub status: Option<FarmStatus>,
}

/// Seconds of processors that a process has used, itself and the system for it. Linux says so in
/// `/proc`, in hundredths of a second; elsewhere it is not known.
#[must_use]
pub fn cpu_of(process: u32) -> Option<f64> {
    /// `USER_HZ`, which is the same on every Linux there is.
    const TICKS_PER_S: f64 = 100.0;
    let stat = std::fs::read_to_string(format!("/proc/{process}/stat")).ok()?;
    // The name, in parentheses, may hold anything; times are the 14th and 15th field.
    let fields = stat.rsplit(')').next()?;
    let mut fields = fields.split_whitespace().skip(11);
    let user: f64 = fields.next()?.parse().ok()?;
    let system: f64 = fields.next()?.parse().ok()?;
    Some((user + system) / TICKS_PER_S)
}

impl Used {
    pub(super) fn between(before: &Usage, after: &Usage, seconds: f64) -> Self {
        let rate = |before: Option<f64>, after: Option<f64>| Some((after? - before?) / seconds);
        let count = |count: fn(&FarmStatus) -> u64| {
            let of = |usage: &Usage| usage.status.as_ref().map_or(0, count);
            of(after).saturating_sub(of(before)) as f64 / seconds
        };
        let status = after.status.as_ref();
        let lags = status.into_iter().flat_map(|status| {
            let newest = status.lies.version;
            let reports = status.shaders.iter().filter_map(|shader| shader.report);
            reports.map(move |report| newest.saturating_sub(report.lie_version))
        });
        Self {
            client_cpu: rate(before.client_cpu_s, after.client_cpu_s),
            constructor_cpu: rate(before.constructor_cpu_s, after.constructor_cpu_s),
            shaders_cpu: rate(before.shaders_cpu_s, after.shaders_cpu_s),
            sent_bytes_per_s: count(|status| status.lies.sent_bytes),
            versions_per_s: count(|status| status.lies.version),
            most_lag: lags.max().unwrap_or(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_that_works_has_used_its_time() {
        let Some(before) = cpu_of(std::process::id()) else {
            return;
        };
        let mut sum = 0u64;
        // Until the clock has gone on: a hundredth of a second.
        while cpu_of(std::process::id()).is_some_and(|now| now <= before) {
            sum = (0..100_000).fold(sum, |sum, number| sum.wrapping_mul(31) ^ number);
        }
        std::hint::black_box(sum);
        assert_eq!(cpu_of(u32::MAX), None);
    }

    #[test]
    fn rates_are_differences_by_time_and_unknown_where_one_end_is() {
        let at = |cpu: Option<f64>| Usage {
            client_cpu_s: cpu,
            ..Usage::default()
        };
        let used = Used::between(&at(Some(1.0)), &at(Some(2.0)), 2.0);
        assert_eq!((used.client_cpu, used.constructor_cpu), (Some(0.5), None));
        assert_eq!(
            Used::between(&at(None), &at(Some(2.0)), 2.0).client_cpu,
            None
        );
    }
}
