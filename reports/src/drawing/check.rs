//! What every figure asks of its input before it draws anything.

use super::axis::{Axis, Scale};
use super::rows::Background;
use crate::FigureError;
use crate::heading::Heading;

/// Numbers beyond this size have no place on an axis: the span between two of them would overflow.
const LARGEST: f64 = 1e100;

/// Checks the input of one figure; errors carry its name.
#[derive(Clone, Copy)]
pub(crate) struct Check<'a> {
    figure: &'a str,
}

impl<'a> Check<'a> {
    /// Checks the heading, and lends its name to the checks that follow.
    pub(crate) fn heading(heading: &'a Heading) -> Result<Self, FigureError> {
        let name = &heading.name;
        let letters = name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-');
        if !letters || !name.starts_with(|first: char| first.is_ascii_lowercase()) {
            return Err(FigureError::Name { name: name.clone() });
        }
        let check = Self { figure: name };
        check.text("the title", &heading.title)?;
        Ok(check)
    }

    pub(crate) fn text(self, what: &str, text: &str) -> Result<(), FigureError> {
        if text.trim().is_empty() { Err(self.empty(what)) } else { Ok(()) }
    }

    pub(crate) fn axis(self, what: &str, axis: &Axis) -> Result<(), FigureError> {
        self.text(&format!("the label of {what}"), &axis.label)?;
        for &value in &axis.include {
            self.on_axis(&format!("a number included in {what}"), value, axis.scale)?;
        }
        Ok(())
    }

    pub(crate) fn empty(self, what: &str) -> FigureError {
        FigureError::Empty { figure: self.figure.to_owned(), what: what.to_owned() }
    }

    pub(crate) fn count(self, what: &str, found: usize, limit: usize) -> Result<(), FigureError> {
        match found {
            0 => Err(self.empty(what)),
            _ if found > limit => {
                Err(FigureError::TooMany { figure: self.figure.to_owned(), what: what.to_owned(), found, limit })
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn length(self, what: &str, found: usize, expected: usize) -> Result<(), FigureError> {
        if found == expected {
            return Ok(());
        }
        Err(FigureError::Length { figure: self.figure.to_owned(), what: what.to_owned(), found, expected })
    }

    pub(crate) fn finite(self, what: &str, value: f64) -> Result<(), FigureError> {
        if value.abs() < LARGEST {
            return Ok(());
        }
        Err(FigureError::NotFinite { figure: self.figure.to_owned(), what: what.to_owned(), value })
    }

    pub(crate) fn on_axis(self, what: &str, value: f64, scale: Scale) -> Result<(), FigureError> {
        self.finite(what, value)?;
        if scale == Scale::Linear || value >= 1.0 / LARGEST {
            return Ok(());
        }
        Err(FigureError::NotPositive { figure: self.figure.to_owned(), what: what.to_owned(), value })
    }

    /// Every value of a list, named by its index, counted from 0.
    pub(crate) fn all_on_axis(self, what: &str, values: &[f64], scale: Scale) -> Result<(), FigureError> {
        for (index, &value) in values.iter().enumerate() {
            if self.on_axis("", value, scale).is_err() {
                self.on_axis(&format!("{what}[{index}]"), value, scale)?;
            }
        }
        Ok(())
    }

    /// Numbers that may stay equal but never fall.
    pub(crate) fn ascending(self, what: &str, values: &[f64]) -> Result<(), FigureError> {
        match values.windows(2).find(|pair| pair[1] < pair[0]) {
            None => Ok(()),
            Some(pair) => Err(FigureError::Order {
                figure: self.figure.to_owned(),
                what: what.to_owned(),
                from: pair[0],
                to: pair[1],
            }),
        }
    }

    /// Levels and band behind the data.
    pub(crate) fn background(self, background: &Background<'_>, scale: Scale) -> Result<(), FigureError> {
        for level in background.levels {
            self.on_axis(&format!("level \"{}\"", level.label), level.value, scale)?;
        }
        if let Some(band) = background.band {
            let name = format!("band \"{}\"", band.label);
            self.all_on_axis(&name, &[band.low, band.high], scale)?;
            self.ascending(&name, &[band.low, band.high])?;
        }
        Ok(())
    }
}
