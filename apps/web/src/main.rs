//! Command line of `make web`, `make web-serve` and `make book`.

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::path::PathBuf;
use tresses_web::{Server, WebPage, build_book, pack};

/// Builds the web pages of Tresses and serves them.
#[derive(Parser)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Build a page into a folder that any static file server can host.
    Build {
        /// Page to build
        #[arg(long, value_enum, default_value_t = WebPage::Studio)]
        page: WebPage,
        /// Output folder; existing files in it are overwritten
        #[arg(long, default_value = "dist")]
        out: PathBuf,
    },
    /// Build the book from docs/ with mdBook.
    Book {
        /// The program mdbook
        #[arg(long, default_value = "mdbook")]
        mdbook: PathBuf,
        /// Output folder
        #[arg(long, default_value = "target/book")]
        out: PathBuf,
    },
    /// Serve a folder, on this machine only.
    Serve {
        /// Folder to serve
        #[arg(long, default_value = "dist")]
        folder: PathBuf,
        /// Port to listen on
        #[arg(long, default_value_t = 8080)]
        port: u16,
    },
}

fn main() -> Result<()> {
    match Cli::parse().command {
        Command::Build { page, out } => {
            let sizes = pack(page, &out, true)?;
            println!("{sizes}");
            sizes.check()
        }
        Command::Book { mdbook, out } => {
            build_book(&mdbook, &out)?;
            println!("{}", out.join("index.html").display());
            Ok(())
        }
        Command::Serve { folder, port } => {
            let server = Server::new(&folder, port)?;
            println!("{} on http://127.0.0.1:{}/", folder.display(), server.port());
            server.run();
            Ok(())
        }
    }
}
