//! The options of pictures, which every command that makes a part has.

use clap::Args;

use crate::job::{PictureOptions, Show, View};

#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures (.png)")]
pub(super) struct PictureArgs {
    /// Show the solid, shaded, from this side: top, iso or front [default: the part as a flat drawing]
    #[arg(long, value_name = "SIDE", value_parser = str::parse::<View>)]
    view: Option<View>,
    /// Mark in a flat drawing: seams, light blue lines where pieces meet; thin, a red ring around each of the ten narrowest
    /// places of ink and of gaps; bridges, struts orange and slits green. Several as seams,thin [default: bridges]
    #[arg(long, value_name = "WHAT", value_delimiter = ',', value_parser = str::parse::<Show>)]
    show: Vec<Show>,
    /// Length of the longer side in pixels [default: 1600]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pixels: Option<u32>,
}

impl PictureArgs {
    pub(super) fn options(&self) -> PictureOptions {
        let default = PictureOptions::default();
        PictureOptions {
            view: self.view,
            show: self.show.clone(),
            pixels: self.pixels.unwrap_or(default.pixels),
        }
    }
}
