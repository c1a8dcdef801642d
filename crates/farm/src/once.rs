//! Warnings that would be the same at every attempt.

/// Logs a line once, until another takes its place.
#[derive(Debug, Default)]
pub(crate) struct Once {
    last: Option<String>,
}

impl Once {
    /// A warning, unless it was the last one as well.
    pub(crate) fn warn(&mut self, line: &str) {
        if self.is_news(line) {
            tracing::warn!("{line}");
        } else {
            tracing::debug!("{line}");
        }
    }

    /// What comes next is news.
    pub(crate) fn forget(&mut self) {
        self.last = None;
    }

    /// Whether this line is another than the last, which it becomes.
    pub(crate) fn is_news(&mut self, line: &str) -> bool {
        let is_news = self.last.as_deref() != Some(line);
        if is_news {
            self.last = Some(line.to_owned());
        }
        is_news
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_differs_from_the_last_is_news() {
        let mut once = Once::default();
        let news = ["a", "a", "b", "b", "a"].map(|line| once.is_news(line));
        assert_eq!(news, [true, false, true, false, true]);
        once.forget();
        assert!(once.is_news("a"));
    }
}
