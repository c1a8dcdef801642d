//! Odd bundles, in a table: what is in the file, and what must be said of it.

use std::io::{BufRead, Read};

use rustls::pki_types::UnixTime;

use super::*;

fn fresh() -> String {
    Bundle::issue(1).unwrap().to_pem()
}

/// The blocks of a bundle: certificate, key, authority.
fn parts(text: &str) -> [String; 3] {
    let blocks = pem::parse_many(text).unwrap();
    let blocks: Vec<_> = blocks.iter().map(pem::encode).collect();
    blocks.try_into().unwrap()
}

fn cannot(content: impl AsRef<[u8]>) -> String {
    let bundle = Bundle::parse(content.as_ref(), "b.pem");
    let usable = bundle.and_then(|bundle| Cluster::new(&bundle));
    usable.unwrap_err().to_string()
}

#[test]
fn what_is_written_is_read_and_of_use() {
    let bundle = Bundle::issue(7).unwrap();
    let read = Bundle::parse(bundle.to_pem().as_bytes(), "b.pem").unwrap();
    assert_eq!(read.to_pem(), bundle.to_pem());
    assert_eq!(read.fingerprint(), bundle.fingerprint());
    assert_eq!(read.validity(), bundle.validity());
    let Validity {
        not_before,
        not_after,
    } = read.validity();
    assert_eq!(not_after - not_before, 7 * 86_400 + 3_600);
    Cluster::new(&read).unwrap();
    // Order and what is between the blocks are of no meaning.
    let [node, key, authority] = parts(&bundle.to_pem());
    let text = format!("{authority}\nhello\r\n{key}# x\n{node}").replace('\n', "\r\n");
    Cluster::new(&Bundle::parse(text.as_bytes(), "b.pem").unwrap()).unwrap();
    // What is secret is not shown by accident.
    assert!(!format!("{bundle:?}").contains("key"));
    for days in [0, MAX_DAYS + 1] {
        assert!(Bundle::issue(days).is_err());
    }
}

#[test]
fn odd_bundles_are_refused_by_name_and_line() {
    let text = fresh();
    let [node, key, authority] = parts(&text);
    let [other_node, other_key, other_authority] = parts(&fresh());
    let whole = [&*node, &key, &authority].concat();
    let lines = |text: &str| text.lines().count();
    let key_line = lines(&node) + 1;
    let authority_line = key_line + lines(&key);
    let spoilt = key.replacen("MIG", "M!G", 1);
    let no_certificate = key.replace("PRIVATE KEY", "CERTIFICATE");
    let request = authority.replace("CERTIFICATE", "CERTIFICATE REQUEST");
    let many: String = (0..9).map(|_| parts(&fresh())[2].clone()).collect();
    let second_line = lines(&whole) + 1;
    let cut = &whole[..whole.len() - 10];
    let mixed = key.replace("END PRIVATE", "END PUBLIC");
    for (content, place, flaw) in [
        (
            String::new(),
            String::new(),
            "there is no certificate in it",
        ),
        (
            "GIF89a".into(),
            String::new(),
            "there is no certificate in it",
        ),
        (
            [&*key, &authority].concat(),
            String::new(),
            "node's certificate is missing",
        ),
        (
            [&*node, &authority].concat(),
            String::new(),
            "private key is missing",
        ),
        (
            [&*node, &key].concat(),
            String::new(),
            "authority is missing",
        ),
        (
            [&*whole, &other_node].concat(),
            format!(":{second_line}"),
            "second node's",
        ),
        (
            [&*whole, &other_key].concat(),
            format!(":{second_line}"),
            "second private key",
        ),
        (
            [&*node, &other_key, &authority].concat(),
            String::new(),
            "not that of the node's",
        ),
        (
            [&*node, &key, &other_authority].concat(),
            String::new(),
            "by none of the authorities",
        ),
        (
            [&*node, &spoilt, &authority].concat(),
            format!(":{key_line}"),
            "cannot be read",
        ),
        (
            [&*node, &mixed, &authority].concat(),
            format!(":{key_line}"),
            "mismatching",
        ),
        (
            [&*node, &no_certificate].concat(),
            format!(":{key_line}"),
            "malformed",
        ),
        (
            [&*node, &key, &request].concat(),
            format!(":{authority_line}"),
            "does not belong",
        ),
        (cut.to_owned(), format!(":{authority_line}"), "has no end"),
        (
            whole.replacen("-----BEGIN C", "C", 1),
            format!(":{}", key_line - 1),
            "never began",
        ),
        (
            [&*node, &key, &many].concat(),
            ":".to_owned(),
            "more than 8 authorities",
        ),
        (
            "#".repeat(Bundle::MAX_LENGTH + 1),
            String::new(),
            "longer than 65536 bytes",
        ),
    ] {
        let error = cannot(&content);
        assert!(
            error.starts_with(&format!("the bundle b.pem{place}")),
            "{error}"
        );
        assert!(error.contains(flaw), "{flaw}: {error}");
    }
    assert!(cannot([0xff, 0xfe]).contains("it is not text"));
    // A certificate with its first byte gone wrong, and with more behind it.
    for (spoil, flaw) in [(0, "malformed"), (1, "malformed")] {
        let mut bytes = pem::parse(&authority).unwrap().into_contents();
        match spoil {
            0 => bytes[0] ^= 0xff,
            _ => bytes.push(0),
        }
        let block = pem::encode(&pem::Pem::new("CERTIFICATE", bytes));
        let error = cannot([&*node, &key, &block].concat());
        assert!(
            error.contains(flaw) && error.contains(&authority_line.to_string()),
            "{error}"
        );
    }
    let missing = Bundle::read("no/such.pem".as_ref())
        .unwrap_err()
        .to_string();
    assert!(
        missing.starts_with("cannot read the bundle no/such.pem: "),
        "{missing}"
    );
    assert!(Bundle::read(std::env::temp_dir().as_path()).is_err());
}

#[test]
fn every_prefix_and_every_flipped_byte_ends_in_an_error_or_a_bundle() {
    let text = fresh();
    for end in 0..text.len() {
        let _ = Bundle::parse(&text.as_bytes()[..end], "b.pem");
    }
    for at in 0..text.len() {
        let mut bytes = text.clone().into_bytes();
        bytes[at] ^= 4;
        if let Ok(bundle) = Bundle::parse(&bytes, "b.pem") {
            let _ = Cluster::new(&bundle);
        }
    }
}

#[test]
fn a_bundle_holds_in_its_time_alone() {
    let bundle = Bundle::issue(10).unwrap();
    let Validity {
        not_before,
        not_after,
    } = bundle.validity();
    let at = |seconds: i64| {
        let time = UnixTime::since_unix_epoch(std::time::Duration::from_secs(seconds as u64));
        Cluster::at(&bundle, time).err()
    };
    assert_eq!(at(not_before - 1), Some(Flaw::NotYetValid(not_before)));
    assert_eq!(at(not_before), None);
    assert_eq!(at(not_after), None);
    assert_eq!(at(not_after + 1), Some(Flaw::Expired(not_after)));
    let day = 20_000 * 86_400 + 3_661;
    assert_eq!(bundle::date(day), "2024-10-04 01:01:01 UTC");
    assert_eq!(bundle::date(i64::MAX), format!("{} s since 1970", i64::MAX));
}

#[test]
fn a_bundle_that_is_handed_over_ends_with_its_last_line() {
    let text = fresh();
    let input = format!("\n{text}and more\n");
    let mut input = input.as_bytes();
    let bundle = Bundle::receive(&mut input, "from there").unwrap();
    assert_eq!(bundle.to_pem(), text);
    let mut rest = String::new();
    input.read_to_string(&mut rest).unwrap();
    assert_eq!(rest, "and more\n");
    // Without that line it ends where the input does.
    let without: String = text
        .lines()
        .filter(|l| !l.contains("end of"))
        .fold(String::new(), |all, line| all + line + "\n");
    Bundle::receive(without.as_bytes(), "from there").unwrap();
    let endless = std::io::BufReader::new(std::io::repeat(b'x'));
    let error = Bundle::receive(endless, "from there").unwrap_err();
    assert!(error.to_string().contains("longer than"), "{error}");
    let mut nothing: &[u8] = b"";
    assert_eq!(nothing.fill_buf().unwrap(), b"");
    assert!(Bundle::receive(nothing, "from there").is_err());
}

#[test]
fn bundles_that_trust_each_other_have_both_authorities_once() {
    let (a, b) = (Bundle::issue(1).unwrap(), Bundle::issue(1).unwrap());
    let (of_a, of_b) = (a.fingerprint(), b.fingerprint());
    assert_ne!(of_a, of_b);
    let a = a.trusting([&b, &b]).unwrap();
    assert_eq!(a.fingerprint(), of_a);
    assert_eq!(a.trusted().collect::<Vec<_>>(), [of_a, of_b]);
    let again = Bundle::parse(a.to_pem().as_bytes(), "b.pem").unwrap();
    assert_eq!(again.trusted().count(), 2);
    let many: Vec<_> = (0..7).map(|_| Bundle::issue(1).unwrap()).collect();
    assert!(again.trusting(&many).is_err());
}
