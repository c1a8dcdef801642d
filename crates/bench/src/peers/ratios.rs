use super::{PeerRatio, Version, round::Judged};
use crate::Spread;

/// All ratios that mean something, of what took part on some number of threads.
pub(super) fn of(all: &[Judged]) -> Vec<PeerRatio> {
    let find = |version: Version, who: &str| {
        let mut all = all.iter();
        all.find(|judged| judged.row.version == version && judged.row.who == who)
    };
    let plain = |who: &str| find(Version::Plain, who);
    let mut ratios = vec![];
    let (hits, visibility) = (plain(Judged::CLOSEST_HITS), plain(Judged::VISIBILITY));
    for variant in all.iter().filter(|judged| judged.row.clean.is_some()) {
        if variant.is_primary {
            // Both find the same hits.
            ratios.push(ratio(variant, hits, hits));
            ratios.push(ratio(variant, visibility, hits));
            continue;
        }
        for version in [Version::Plain, Version::AsItIs] {
            for who in [Judged::STANDARD, Judged::LIE] {
                let ours = find(version, who);
                ratios.push(ratio(variant, ours, ours));
            }
        }
    }
    for version in [Version::Plain, Version::AsItIs] {
        let ours = |who: &str| find(version, who);
        let lie = ours(Judged::LIE);
        for (over, under) in [
            (Judged::STANDARD, Judged::LIE),
            (Judged::LIE, Judged::VISIBILITY),
        ] {
            ratios.extend(ours(over).map(|over| ratio(over, ours(under), lie)));
        }
    }
    ratios.into_iter().flatten().collect()
}

/// Marks the fastest of the other program's variants that trace shadow rays in packets.
pub(super) fn mark_best(all: &mut [Judged]) {
    const ONE_BY_ONE: &str = "embree occ1";
    let coherent = all.iter_mut().filter(|judged| {
        judged.row.clean.is_some() && !judged.is_primary && judged.row.who != ONE_BY_ONE
    });
    let best = coherent.min_by(|a, b| {
        let (a, b) = (a.row.frame_ms.median, b.row.frame_ms.median);
        a.total_cmp(&b)
    });
    if let Some(best) = best {
        best.row.is_best = true;
    }
}

/// One time by another, beside the error of a picture of ours.
fn ratio(over: &Judged, under: Option<&Judged>, picture: Option<&Judged>) -> Option<PeerRatio> {
    let (under, picture) = (under?, picture?);
    let pairs = over.times_ms.iter().zip(&under.times_ms);
    let ratios: Vec<f64> = pairs.map(|(over, under)| over / under).collect();
    Some(PeerRatio {
        scene: under.row.scene.clone(),
        version: under.row.version,
        threads: under.row.threads,
        over: over.row.who.clone(),
        under: under.row.who.clone(),
        is_best: over.row.is_best,
        ratio: Spread::of(&ratios)?,
        from_peer: picture.row.from_peer,
        relative_rmse: picture.row.relative_rmse,
    })
}
