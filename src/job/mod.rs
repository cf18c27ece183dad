//! Whole jobs: a band along a curve, a rectangle, an area that is filled, a solid from any SVG.
//!
//! A builder collects options, `build()` checks them by name, `run()` computes, and the result encodes itself
//! as files that are read again and verified before they have their names. All rooms meet here, and nothing
//! is decided here that a room could decide.
//!
//! ```
//! use openwork::job::{BandBuilder, Format, Output};
//!
//! let folder = tempfile::tempdir()?;
//! let svg = folder.path().join("bracelet.svg");
//! let band = BandBuilder::new("fixtures/exemplars/vine.svg", "circle:65mm".parse()?)
//!     .width_mm(14.0)
//!     .components(1)
//!     .closed_pattern(true)
//!     .build()?
//!     .run(&mut |_| {})?;
//! let report = band.write(&[Output::file(&svg)?], None, &mut |_| {})?;
//! assert_eq!((report.components, report.closed_pattern), (1, true));
//! # assert!(svg.exists());
//! # assert_eq!(Output::file("x.stl")?.format(), Format::Stl);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod band;
mod blind;
mod bridging;
mod builder;
mod certificate;
mod choice;
mod cut;
mod deliver;
mod describe;
mod drape;
mod engrave;
mod error;
mod extrude;
mod fill;
mod flat;
mod joined;
mod json;
mod judged;
mod laser;
mod making;
mod notes;
mod output;
mod part;
mod picture;
mod plan;
mod planning;
mod points;
mod print;
mod raised;
mod rect;
mod rect_builder;
mod rect_report;
mod rect_rows;
mod rect_search;
mod rect_strip;
mod rect_tile;
mod recut;
mod refusal;
mod report;
mod scene;
mod several;
mod small;
mod space;
mod stage;
mod surface;
mod unrolled;
mod ways;

pub use crate::reeb::KeptRange;
pub use band::Band;
pub use bridging::BridgesReport;
pub use builder::{BandBuilder, BandJob, SlicingChoice};
pub use certificate::{
    BridgeStep, Certificate, Closing, Connections, FileDigest, PieceDescriptor, ResultCounts, Source, Steps,
    WantedCounts,
};
pub use choice::{Choice, Chosen, DEFAULT_TEMPERATURE, choose};
pub use cut::READ_SHARE;
pub use drape::{Drape, DrapeError};
pub use error::{JobError, OutlineFault};
pub use extrude::{ExtrudeBridges, ExtrudeReport, extrude};
pub use fill::{
    ChangeReport, CloneSpec, Density, Fill, FillBuilder, FillJob, FillReport, LevelReport, SampleBorder,
    SampleOptions, SampleStart, SampleWithout, UnmatchedPrice,
};
pub use flat::FlatMaking;
pub use laser::{LaserFile, LaserOptions, LaserReport};
pub use making::{EnforcedReport, Quantities};
pub use output::{Format, Output, Target};
pub use picture::{PictureOptions, Show};
pub use plan::{DEFAULT_MEMORY_LIMIT, Plan, PlanError, PlanOptions, SEED_SPREAD, plan};
pub use points::Points;
pub use print::PrintOptions;
pub use rect::Rect;
pub use rect_builder::{RectBuilder, RectJob};
pub use rect_report::{Attempt, DirectionReport, RectReport};
pub use recut::recut;
pub use report::{
    BandReport, DroppedCutReport, FallbackReport, FlatPattern, InputReport, MadeReport, SeamReport,
    StageTime, StitchReport, SurfaceReport,
};
pub use scene::{
    Axis, CopyReport, Joint, JointReport, Making, PartReport, Placement, Repeat, Scene, ScenePart,
    SceneReport, Step, Strip,
};
pub use several::write_numbered;
pub use space::SpaceOptions;
pub use stage::Stage;
pub use surface::{ControlPoints, Ground, Height, Route, RouteError, SurfaceMode, SurfaceOptions};
pub use ways::WayReport;

pub use crate::export::{Curves, DxfVersion, LayerColours, View};
pub use crate::fabricate::SheetSize;
pub use crate::fabricate::{Material, Process, Workshop};
pub use crate::fit::StitchMethod;
pub use crate::topology::{Wanted, WantedError};
