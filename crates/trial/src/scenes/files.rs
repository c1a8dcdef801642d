/// Names that files in an input may have. There are no others, so that no input writes elsewhere.
const NAMES: [&str; 8] = [
    "main.obj",
    "main.mtl",
    "main.gltf",
    "main.bin",
    "scene.toml",
    "box.obj",
    "wood.png",
    "wood.jpg",
];

/// What precedes a file's name.
const MARK: &[u8] = b"\n~~~~ ";

/// Several files in one input: before each a line with `~~~~` and its name.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Files(pub(crate) Vec<(&'static str, Vec<u8>)>);

impl Files {
    /// The files in an input. What has no known name is left out.
    pub(crate) fn split(bytes: &[u8]) -> Self {
        let mut files = Vec::new();
        let mut rest = find(bytes).map_or(&[][..], |at| &bytes[at + MARK.len()..]);
        while !rest.is_empty() {
            let end = find(rest).unwrap_or(rest.len());
            let (file, next) = rest.split_at(end);
            let known = NAMES.iter().find_map(|name| {
                let content = file.strip_prefix(name.as_bytes())?.strip_prefix(b"\n")?;
                Some((*name, content.to_vec()))
            });
            files.extend(known);
            rest = next.get(MARK.len()..).unwrap_or_default();
        }
        Self(files)
    }

    /// The input with these files.
    pub(crate) fn joined(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (name, content) in &self.0 {
            for piece in [MARK, name.as_bytes(), b"\n", content] {
                bytes.extend_from_slice(piece);
            }
        }
        bytes
    }
}

fn find(bytes: &[u8]) -> Option<usize> {
    bytes.windows(MARK.len()).position(|piece| piece == MARK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_come_back_and_others_do_not() {
        let files = Files(vec![
            ("main.obj", b"v 1 2 3\n".to_vec()),
            ("main.mtl", vec![]),
        ]);
        let joined = files.joined();
        assert_eq!(Files::split(&joined), files);
        let text = String::from_utf8(joined).unwrap();
        let foreign = text.replace("main.mtl", "../../a");
        assert_eq!(Files::split(foreign.as_bytes()).0, files.0[..1]);
        assert_eq!(Files::split(b"anything"), Files(vec![]));
    }
}
