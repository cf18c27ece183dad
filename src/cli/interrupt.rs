//! An interruption leaves nothing behind: no temporary file, and no half of a line on the terminal.
//!
//! A thread waits for the signals that end a program and cleans up before they do. The program then ends by the
//! signal itself, as if it had never been caught: a shell shows 128 and the number of the signal, and a script that
//! runs the program in a loop stops as well. What whoever started the program had switched off stays off: `nohup` and
//! `&` in a script rely on that. Excluded: a program that is killed outright (`kill -9`) cleans nothing up.

/// Cleans up for every signal that ends the program from now on.
///
/// Without a handler, for want of a thread or a pipe, a signal still ends the program, only a temporary file may stay behind.
pub(super) fn leave_nothing_behind() {
    #[cfg(unix)]
    unix::watch();
    #[cfg(not(unix))]
    let _ = ctrlc::set_handler(|| {
        clean_up();
        // As a shell would show it.
        std::process::exit(130);
    });
}

fn clean_up() {
    super::progress::clear();
    crate::export::remove_staged();
}

#[cfg(unix)]
mod unix {
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::flag;
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    pub(super) fn watch() {
        // Caught and forgotten: a file that grows beyond `ulimit -f` is then an error of the write like any other.
        let _ = flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
        let ignored = ignored(&std::fs::read_to_string("/proc/self/status").unwrap_or_default());
        let signals = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|&signal| match ignored {
            Some(mask) => mask >> (signal - 1) & 1 == 0,
            // Where the system does not tell, a closed terminal is left to `nohup`.
            None => signal != SIGHUP,
        });
        let Ok(mut signals) = Signals::new(signals) else { return };
        let wait = move || {
            if let Some(signal) = signals.forever().next() {
                super::clean_up();
                // Ends the program; if it cannot, the code says the same.
                let _ = emulate_default_handler(signal);
                std::process::exit(128 + signal);
            }
        };
        let _ = std::thread::Builder::new().name("interrupt".to_owned()).spawn(wait);
    }

    /// The signals that are ignored, a bit for each from signal 1 on, as Linux tells it in `/proc/self/status`.
    pub(super) fn ignored(status: &str) -> Option<u64> {
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
        u64::from_str_radix(mask.trim(), 16).ok()
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn ignored_signals_are_read_from_the_status() {
            let status =
                "Name:\topenwork\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001001\nSigCgt:\t2\n";
            assert_eq!(ignored(status), Some(0x1001));
            assert_eq!(ignored("Name:\topenwork\n"), None);
        }
    }
}
