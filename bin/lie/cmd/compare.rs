use std::path::PathBuf;

use clap::Args;

use crate::{
    args::{say, write_json},
    failure::OrUsage,
};

/// Measures how far a picture is from a reference: relative RMSE, PSNR and FLIP.
///
/// Both are EXR or PNG, of one size. PNGs are decoded to linear light first. PSNR and FLIP
/// look at both as a display would show them.
#[derive(Args)]
pub(crate) struct Compare {
    /// The picture.
    a: PathBuf,
    /// The reference.
    b: PathBuf,
    /// Exposure in stops at which PSNR and FLIP look at the pictures.
    #[arg(
        long,
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_name = "STOPS"
    )]
    exposure: f32,
    /// Write the figures to this file as JSON.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

pub(crate) fn execute(arguments: &Compare) -> anyhow::Result<()> {
    let a = lie_render::read_image(&arguments.a).or_usage()?;
    let b = lie_render::read_image(&arguments.b).or_usage()?;
    let figures = lie_render::compare(&a, &b, arguments.exposure).or_usage()?;
    say(format_args!(
        "relative RMSE   {:.6} %",
        100.0 * figures.relative_rmse
    ))?;
    say(format_args!(
        "  without 0.1 % {:.6} %",
        100.0 * figures.relative_rmse_p999
    ))?;
    say(format_args!("PSNR            {:.2} dB", figures.psnr_db))?;
    say(format_args!("FLIP, mean      {:.6}", figures.flip_mean))?;
    say(format_args!(
        "pixels differ   {:.4} %",
        100.0 * figures.differing
    ))?;
    if let Some(path) = &arguments.json {
        // JSON has no infinity: equal pictures have a PSNR of null.
        let figures = serde_json::json!({
            "relative_rmse": figures.relative_rmse,
            "relative_rmse_p999": figures.relative_rmse_p999,
            "psnr_db": figures.psnr_db.is_finite().then_some(figures.psnr_db),
            "flip_mean": figures.flip_mean,
            "differing_fraction": figures.differing,
        });
        write_json(path, &figures)?;
    }
    Ok(())
}
