//! ROBOT on the command line.

use armid::model::format::ChainEnds;
use armid_io::{Error, LoadedRobot, robot};

/// Which robot.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct RobotArguments {
    /// A bundled name (`armid robot` lists them), robot.toml, URDF or MJCF
    pub(crate) robot: String,
    #[command(flatten)]
    pub(crate) chain: ChainArguments,
}

/// Which chain of a tree.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct ChainArguments {
    /// Link at which the chain begins, in a URDF or MJCF tree
    #[arg(long, value_name = "LINK")]
    pub(crate) base_link: Option<String>,
    /// Link at which the chain ends, in a URDF or MJCF tree
    #[arg(long, value_name = "LINK")]
    pub(crate) tip_link: Option<String>,
}

impl RobotArguments {
    pub(crate) fn load(&self) -> Result<LoadedRobot, Error> {
        self.chain.load(&self.robot)
    }
}

impl ChainArguments {
    /// The robot that is called so.
    pub(crate) fn load(&self, name: &str) -> Result<LoadedRobot, Error> {
        robot::load(name, &self.ends(), None)
    }

    /// The robot that is called so, with the links of its chain, as on a command line.
    pub(crate) fn on_command_line(&self, name: &str) -> String {
        let links = [("--base-link", &self.base_link), ("--tip-link", &self.tip_link)];
        let links = links.into_iter().filter_map(|(flag, link)| Some(format!(" {flag} {}", link.as_ref()?)));
        std::iter::once(name.to_owned()).chain(links).collect()
    }

    /// The links at which it begins and ends.
    pub(crate) fn ends(&self) -> ChainEnds {
        ChainEnds { base: self.base_link.clone(), tip: self.tip_link.clone() }
    }
}
