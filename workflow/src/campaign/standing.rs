//! How a campaign stands, with its estimate and its figure.

use armid_io::Error;
use armid_io::output::{pretty, write_text};
use serde_json::json;

use super::aim::Aim;
use super::answer::{CampaignAnswer, RoundAnswer};
use super::figure;
use super::folder::stated_inputs;
use super::state::Campaign;
use super::stopping::{Obstacle, Width, is_out_of_reach};

impl Campaign {
    /// How it stands, with its estimate and its figure in the folder.
    ///
    /// # Errors
    /// [`Error`] where one of them cannot be written.
    pub fn answer(&self) -> Result<CampaignAnswer, Error> {
        let mut total_s = 0.0;
        let rounds = self.rounds.iter().zip(&self.pooled).enumerate().map(|(k, (round, pooled))| {
            total_s += round.seconds;
            RoundAnswer {
                number: round.number,
                seconds: round.seconds,
                total_s,
                widened_by: pooled.widened_by,
                widths: self.widths.iter().map(|widths| widths[k]).collect(),
            }
        });
        let rounds = rounds.collect();
        let targets = || self.aims.iter().zip(&self.widths);
        let is_met = |(aim, widths): (&Aim, &Vec<Width>)| {
            widths.last().is_some_and(|last| last.half_width <= aim.target.limit())
        };
        let obstacles = self.pooled.last().filter(|_| self.is_model_error_shown()).map_or_else(Vec::new, |last| {
            let blocked = targets().filter(|(aim, widths)| is_out_of_reach(aim.target.limit(), widths));
            blocked.map(|(aim, _)| Obstacle::of(&aim.target, &last.estimate)).collect()
        });
        let mut answer = CampaignAnswer {
            robot: self.loaded.robot.name().to_owned(),
            outcome: self.outcome(),
            targets: self.settings.until.clone(),
            units: self.aims.iter().map(|aim| aim.unit.clone()).collect(),
            met: targets().map(is_met).collect(),
            obstacles,
            added_terms: self.added_terms.clone(),
            most_rounds: self.settings.most_rounds,
            rounds,
            estimate: None,
            figure: None,
        };
        if let Some(pooled) = self.pooled.last() {
            let place = self.folder.join("estimate.json");
            let mut value = json!(pooled.estimate);
            if let Some(last) = self.rounds.last() {
                // Paths begin in the folder, where this file is.
                value["inputs"] = stated_inputs(&last.together())?;
            }
            write_text(&place, &pretty(&value))?;
            answer.estimate = Some(place);
        }
        if let Some(svg) = figure::svg(&answer)? {
            let place = self.folder.join("progress.svg");
            write_text(&place, &svg)?;
            answer.figure = Some(place);
        }
        Ok(answer)
    }
}
