use lie_octree::CellState;
use lie_protocol::LieDelta;

use crate::convert::{self, ConvertError};

/// Collects the parts of LIE updates.
#[derive(Default)]
pub(super) struct Assembly {
    cells: Vec<CellState>,
    next_part: u32,
    /// Versions of the first part: from and to.
    versions: (u64, u64),
}

/// Most parts of one update: 2 GiB at 4 MiB for each, forty times the paper's largest scene.
const MAX_PARTS: u32 = 512;

/// A whole update.
#[derive(Debug, PartialEq)]
pub(super) struct Update {
    /// 0 is a snapshot.
    pub(super) from_version: u64,
    pub(super) to_version: u64,
    pub(super) cells: Vec<CellState>,
}

/// Why parts do not make an update.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum AssemblyError {
    #[error("part {got} of a LIE update came where part {expected} belongs")]
    Order { expected: u32, got: u32 },
    #[error("a LIE update has more than {MAX_PARTS} parts")]
    TooLong,
    #[error("the parts of a LIE update belong to different versions")]
    Versions,
    #[error(transparent)]
    Cell(#[from] ConvertError),
}

impl Assembly {
    /// Takes a part; gives the update if it was the last.
    pub(super) fn add(&mut self, part: LieDelta) -> Result<Option<Update>, AssemblyError> {
        if part.part != self.next_part {
            return Err(AssemblyError::Order {
                expected: self.next_part,
                got: part.part,
            });
        }
        let versions = (part.from_version, part.to_version);
        if part.part == 0 {
            self.versions = versions;
        }
        if versions != self.versions {
            return Err(AssemblyError::Versions);
        }
        if part.part >= MAX_PARTS {
            return Err(AssemblyError::TooLong);
        }
        self.next_part += 1;
        for cell in part.cells {
            self.cells.push(convert::cell(cell)?);
        }
        if !part.last {
            return Ok(None);
        }
        self.next_part = 0;
        Ok(Some(Update {
            from_version: part.from_version,
            to_version: part.to_version,
            cells: std::mem::take(&mut self.cells),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lie_protocol::{WireBody, WireCell};

    fn part(part: u32, last: bool, key: u64) -> LieDelta {
        LieDelta {
            from_version: 3,
            to_version: 5,
            part,
            last,
            cells: vec![WireCell {
                key,
                version: 4,
                body: WireBody::Interior,
            }],
        }
    }

    #[test]
    fn an_update_is_whole_only_with_its_last_part() {
        let mut assembly = Assembly::default();
        assert_eq!(assembly.add(part(0, false, 1)), Ok(None));
        let update = assembly.add(part(1, true, 8)).unwrap().unwrap();
        assert_eq!((update.from_version, update.to_version), (3, 5));
        assert_eq!(update.cells.len(), 2);
        assert!(assembly.add(part(0, true, 1)).unwrap().is_some());
    }

    #[test]
    fn a_missing_part_and_an_impossible_cell_are_noticed() {
        let mut assembly = Assembly::default();
        let order = AssemblyError::Order {
            expected: 0,
            got: 1,
        };
        assert_eq!(assembly.add(part(1, true, 1)), Err(order));
        let impossible = assembly.add(part(0, true, 0));
        assert!(matches!(impossible, Err(AssemblyError::Cell(_))));
    }

    #[test]
    fn parts_of_other_versions_and_parts_without_end_are_refused() {
        let mut assembly = Assembly::default();
        assert_eq!(assembly.add(part(0, false, 1)), Ok(None));
        let other = LieDelta {
            to_version: 6,
            ..part(1, true, 1)
        };
        assert_eq!(assembly.add(other), Err(AssemblyError::Versions));
        for index in 1..MAX_PARTS {
            assert_eq!(assembly.add(part(index, false, 1)), Ok(None));
        }
        let endless = assembly.add(part(MAX_PARTS, false, 1));
        assert_eq!(endless, Err(AssemblyError::TooLong));
    }
}
