//! How a farm is, asked of its constructor.

use lie_protocol::{ConstructorToObserver as In, FarmStatus, Role};

use crate::{
    connection::{self, LinkError},
    handshake,
    network::{self, Exposure, NetworkError},
};

/// Why it cannot be said how a farm is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StatusError {
    /// The constructor cannot be reached.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The constructor does not answer, or not to us.
    #[error("the constructor at {address}: {cause}")]
    Constructor {
        /// Its address.
        address: String,
        /// What happened.
        cause: LinkError,
    },
}

/// Asks once. Every question is a connection of its own, which disturbs nobody and takes no
/// client's place.
///
/// # Errors
/// [`StatusError`], in one line.
pub async fn ask(address: &str, exposure: &Exposure) -> Result<FarmStatus, StatusError> {
    let stream = network::dial_constructor(address, exposure).await?;
    let (mut receiver, mut sender) = connection::split(stream);
    let hello = handshake::hello(Role::Observer, 0, 0);
    let cause = match handshake::greet(&mut receiver, &mut sender, hello).await {
        Ok(In::Status(status)) => return Ok(status),
        Ok(In::Refuse(refusal)) => handshake::refused(&receiver, refusal),
        Err(error) => error,
    };
    Err(StatusError::Constructor {
        address: address.to_owned(),
        cause,
    })
}
