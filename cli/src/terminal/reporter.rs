//! How errors are shown.

use std::io::IsTerminal;

/// With the lines around their place; in colour and wrapped only where a terminal shows them.
pub(crate) fn install_reporter() {
    let terminal = std::io::stderr().is_terminal();
    // A second call is the only way to fail, and there is none.
    let _ = miette::set_hook(Box::new(move |_| {
        let options = miette::MietteHandlerOpts::new().width(100).context_lines(1).wrap_lines(terminal);
        Box::new(if terminal { options } else { options.color(false) }.build())
    }));
}
