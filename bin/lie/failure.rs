/// The user asked for something that cannot be: bad arguments or a bad input file. Ends in
/// exit code 2; everything else that fails ends in 1.
#[derive(Debug)]
pub(crate) struct Usage(anyhow::Error);

impl std::fmt::Display for Usage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // The whole chain on one line: an outer error often only names the place.
        write!(f, "{:#}", self.0)
    }
}

impl std::error::Error for Usage {}

/// Marks an error as the user's to mend.
pub(crate) trait OrUsage<T> {
    /// The value, or the error as a [`Usage`].
    fn or_usage(self) -> Result<T, Usage>;
}

impl<T, E: Into<anyhow::Error>> OrUsage<T> for Result<T, E> {
    fn or_usage(self) -> Result<T, Usage> {
        self.map_err(|error| Usage(error.into()))
    }
}

/// A [`Usage`] error with this message.
pub(crate) fn usage(
    message: impl std::fmt::Display + Send + Sync + std::fmt::Debug + 'static,
) -> Usage {
    Usage(anyhow::Error::msg(message))
}

/// Exit code of a failed command.
pub(crate) fn exit_code(error: &anyhow::Error) -> u8 {
    if error.is::<Usage>() { 2 } else { 1 }
}
