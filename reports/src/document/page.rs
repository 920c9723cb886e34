//! The HTML page.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::paragraph::{marked, printable};
use super::{Block, Cell, Column, Document, RenderedFigure, Section, Table};
use crate::DocumentError;

/// Everything the page needs to look right: no font, script or image is fetched. Print keeps figures and rows whole and
/// unfolds what is folded.
const STYLE: &str = include_str!("page.css");

/// Sorts a table by the column whose heading is clicked, or chosen with the Enter key. The page is whole without it.
const SORTING: &str = include_str!("page.js");

/// Numbers handed out while the page is written.
#[derive(Default)]
struct Counters {
    figures: usize,
    tables: usize,
}

impl Document {
    /// The document as one HTML page that needs nothing beside itself; equal documents give equal bytes.
    ///
    /// # Errors
    /// [`DocumentError`] where the title or a heading is empty, two figures have one name, or a table row does not have
    /// one cell per column.
    pub fn html(&self) -> Result<String, DocumentError> {
        let empty = |what: &str| DocumentError::Empty { what: what.to_owned(), expected: "a text" };
        if self.title.trim().is_empty() {
            return Err(empty("the title of the document"));
        }
        self.check_names()?;
        for section in &self.sections {
            if section.heading.trim().is_empty() {
                return Err(empty("the heading of a section"));
            }
            for block in &section.blocks {
                if let Block::Table(table) = block {
                    table.check()?;
                }
            }
        }
        Ok(render(self))
    }
}

fn render(document: &Document) -> String {
    let mut counters = Counters::default();
    let sections: Vec<Markup> = document
        .sections
        .iter()
        .enumerate()
        .map(|(index, section)| render_section(section, index + 1, &mut counters))
        .collect();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (printable(&document.title.replace(['`', '*'], ""))) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (marked(&document.title)) }
                    @if !document.subtitle.trim().is_empty() { p.subtitle { (marked(&document.subtitle)) } }
                }
                main {
                    @if !document.summary.is_empty() {
                        section.summary aria-label="Summary" {
                            @for paragraph in &document.summary { p { (marked(paragraph)) } }
                        }
                    }
                    @if document.sections.len() > 1 { (contents(document)) }
                    @for section in &sections { (section) "\n" }
                }
                @if !document.provenance.is_empty() {
                    footer {
                        h2 #provenance { "Provenance" }
                        dl {
                            @for (name, value) in &document.provenance {
                                dt { (marked(name)) }
                                dd { (marked(value)) }
                            }
                        }
                    }
                }
                script { (PreEscaped(SORTING)) }
            }
        }
    };
    let mut text = page.into_string();
    text.push('\n');
    text
}

fn contents(document: &Document) -> Markup {
    html! {
        nav aria-label="Contents" {
            h2 { "Contents" }
            ol {
                @for (index, section) in document.sections.iter().enumerate() {
                    li { a href={ "#section-" (index + 1) } { (marked(&section.heading)) } }
                }
            }
        }
    }
}

fn render_section(section: &Section, number: usize, counters: &mut Counters) -> Markup {
    let blocks: Vec<Markup> = section.blocks.iter().map(|block| render_block(block, counters)).collect();
    html! {
        section {
            h2 id={ "section-" (number) } { (number) ". " (marked(&section.heading)) }
            @for block in &blocks { (block) "\n" }
        }
    }
}

fn render_block(block: &Block, counters: &mut Counters) -> Markup {
    match block {
        Block::Text(text) => html! { p { (marked(text)) } },
        Block::List(items) => html! { ul { @for item in items { li { (marked(item)) } } } },
        Block::Links(links) => {
            html! { ul { @for (text, address) in links { li { a href=(printable(address)) { (marked(text)) } } } } }
        }
        Block::Figure(figure) => {
            counters.figures += 1;
            render_figure(figure, counters.figures)
        }
        Block::Table(table) => {
            counters.tables += 1;
            render_table(table, counters.tables)
        }
    }
}

fn render_figure(figure: &RenderedFigure, number: usize) -> Markup {
    html! {
        figure id={ "figure-" (figure.name) } {
            // Written by this crate, escaped where it was written.
            div.scroll { (PreEscaped(&figure.svg)) }
            figcaption {
                strong { "Figure " (number) "." } " "
                @if figure.caption.trim().is_empty() { (marked(&figure.title)) } @else { (marked(&figure.caption)) }
                " " span.file { (figure.name) ".svg" }
            }
        }
    }
}

fn render_table(table: &Table, number: usize) -> Markup {
    let count = table.rows.len();
    if count >= Table::FOLDED_FROM {
        html! {
            details.table id={ "table-" (number) } {
                summary { strong { "Table " (number) "." } " " (marked(&table.caption)) " " span.file { (count) " rows" } }
                div.scroll { table { (rows(table)) } }
            }
        }
    } else {
        html! {
            // The caption keeps the width of the page where the table is wider and scrolls.
            div.table id={ "table-" (number) } {
                p.caption id={ "table-" (number) "-caption" } { strong { "Table " (number) "." } " " (marked(&table.caption)) }
                div.scroll { table aria-labelledby={ "table-" (number) "-caption" } { (rows(table)) } }
            }
        }
    }
}

/// Numbers stand right; a short name is not broken at its hyphen.
fn class_of(cell: &Cell, column: &Column) -> Option<&'static str> {
    let is_name = |text: &str| text.len() <= 24 && text.contains('-') && !text.contains(' ');
    match cell {
        _ if column.numeric => Some("number"),
        Cell::Text(text) if is_name(text) => Some("name"),
        _ => None,
    }
}

fn rows(table: &Table) -> Markup {
    html! {
        thead {
            tr {
                @for column in &table.columns {
                    th scope="col" class=[column.numeric.then_some("number")] {
                        (marked(&column.label))
                        @if !column.unit.is_empty() { br; span.unit { (printable(&column.unit)) } }
                    }
                }
            }
        }
        tbody {
            @for cells in &table.rows {
                tr {
                    @for (cell, column) in cells.iter().zip(&table.columns) {
                        td class=[class_of(cell, column)] {
                            @match cell { Cell::Text(text) => (marked(text)), other => (other.written()) }
                        }
                    }
                }
                "\n"
            }
        }
    }
}
