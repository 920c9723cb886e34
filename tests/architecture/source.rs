//! What a source file says to the compiler of the library itself: everything compiled only for tests is left out.

use proc_macro2::{TokenStream, TokenTree};
use syn::ext::IdentExt;
use syn::visit::{self, Visit};

/// A path that a file names, `["crate", "model", "Robot"]`, each `use` expanded to one path for each name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct NamedPath {
    pub(crate) segments: Vec<String>,
    pub(crate) line: usize,
    /// Inline modules around it.
    pub(crate) inline: usize,
}

/// A word with the line it stands on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Word {
    pub(crate) text: String,
    pub(crate) line: usize,
}

/// A file of the library, as far as its invariants are concerned.
#[derive(Default)]
pub(crate) struct Source {
    /// Every path, those inside macros too.
    pub(crate) paths: Vec<NamedPath>,
    /// Every method that is called.
    pub(crate) methods: Vec<Word>,
    /// Every macro that is called, without its `!`.
    pub(crate) macros: Vec<Word>,
    /// Every module that is declared.
    pub(crate) modules: Vec<Word>,
    /// Modules in files of their own that exist only in tests: `#[cfg(test)] mod name;`.
    pub(crate) test_modules: Vec<String>,
    /// Where anything but a `mod` or a `use` stands at the top of the file.
    pub(crate) logic: Vec<usize>,
    /// Names that the file hands on: the path after `pub use`, and the name it has from then on.
    pub(crate) exports: Vec<(Vec<String>, String)>,
    /// Every string, those of macros and attributes too, documentation aside.
    pub(crate) texts: Vec<Word>,
    /// Attributes of the whole file, as text.
    pub(crate) attributes: Vec<String>,
    inline: usize,
}

impl Source {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// [`syn::Error`] if it is not Rust.
    pub(crate) fn read(text: &str) -> syn::Result<Self> {
        let file = syn::parse_file(text)?;
        let mut source = Self::default();
        for item in file.items.iter().filter(|item| !is_test_only(attributes(item))) {
            if !matches!(item, syn::Item::Mod(module) if module.content.is_none()) && !matches!(item, syn::Item::Use(_))
            {
                source.logic.push(line(syn::spanned::Spanned::span(item)));
            }
        }
        for attribute in &file.attrs {
            source.attributes.push(quote_free(&attribute.meta));
        }
        source.visit_file(&file);
        Ok(source)
    }

    /// The first names below a root, as in `root::name` and `root::{name, other::deeper}`, with their lines.
    pub(crate) fn names_below(&self, root: &str) -> Vec<Word> {
        let below = |path: &NamedPath| match path.segments.as_slice() {
            [first, name, ..] if first == root => Some(Word { text: name.clone(), line: path.line }),
            _ => None,
        };
        self.paths.iter().filter_map(below).collect()
    }

    /// Paths of `super`s that are long enough to reach the root of the crate from a file `depth` modules below it.
    pub(crate) fn climbs_to_root(&self, depth: usize) -> Vec<usize> {
        let climb = |path: &NamedPath| path.segments.iter().take_while(|segment| *segment == "super").count();
        let reaching = self.paths.iter().filter(|path| climb(path) > 0 && climb(path) >= depth + path.inline);
        reaching.map(|path| path.line).collect()
    }

    fn add(&mut self, segments: Vec<String>, line: usize) {
        self.paths.push(NamedPath { segments, line, inline: self.inline });
    }

    /// Every path of a `use`.
    fn add_tree(&mut self, tree: &syn::UseTree, before: &[String], is_exported: bool) {
        let with = |ident: &syn::Ident| [before, &[ident.unraw().to_string()]].concat();
        let mut add = |ident: &syn::Ident, name: &syn::Ident| {
            let path = with(ident);
            if is_exported {
                self.exports.push((path.clone(), name.to_string()));
            }
            self.add(path, line(ident.span()));
        };
        match tree {
            syn::UseTree::Name(leaf) => add(&leaf.ident, &leaf.ident),
            syn::UseTree::Rename(leaf) => add(&leaf.ident, &leaf.rename),
            syn::UseTree::Glob(star) => {
                let line = line(star.star_token.spans[0]);
                self.add([before, &["*".to_owned()]].concat(), line);
            }
            syn::UseTree::Path(path) => self.add_tree(&path.tree, &with(&path.ident), is_exported),
            syn::UseTree::Group(group) => {
                for tree in &group.items {
                    self.add_tree(tree, before, is_exported);
                }
            }
        }
    }

    /// What stands in the arguments of a macro, whose grammar is its own: paths, method calls and macros.
    fn scan(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let ident = |k: usize| match tokens.get(k) {
            Some(TokenTree::Ident(ident)) => Some(ident),
            _ => None,
        };
        let is = |k: usize, mark: char| matches!(tokens.get(k), Some(TokenTree::Punct(p)) if p.as_char() == mark);
        let mut k = 0;
        while k < tokens.len() {
            match &tokens[k] {
                TokenTree::Group(group) => self.scan(group.stream()),
                TokenTree::Literal(literal) => {
                    self.texts.push(Word { text: literal.to_string(), line: line(literal.span()) });
                }
                TokenTree::Ident(_) | TokenTree::Punct(_) => {}
            }
            let Some(first) = ident(k) else {
                k += 1;
                continue;
            };
            let (begin, mut segments) = (k, vec![first.to_string()]);
            while is(k + 1, ':')
                && is(k + 2, ':')
                && let Some(next) = ident(k + 3)
            {
                segments.push(next.to_string());
                k += 3;
            }
            let at = line(first.span());
            if begin > 0 && is(begin - 1, '.') && matches!(tokens.get(k + 1), Some(TokenTree::Group(_))) {
                self.methods.push(Word { text: segments[0].clone(), line: at });
            } else if is(k + 1, '!') && matches!(tokens.get(k + 2), Some(TokenTree::Group(_))) {
                self.macros.push(Word { text: segments[segments.len() - 1].clone(), line: at });
            }
            self.add(segments, at);
            k += 1;
        }
    }
}

impl<'a> Visit<'a> for Source {
    fn visit_item(&mut self, item: &'a syn::Item) {
        if !is_test_only(attributes(item)) {
            visit::visit_item(self, item);
        } else if let syn::Item::Mod(module) = item
            && module.content.is_none()
        {
            self.test_modules.push(module.ident.to_string());
        }
    }

    fn visit_impl_item(&mut self, item: &'a syn::ImplItem) {
        let syn::ImplItem::Fn(function) = item else { return visit::visit_impl_item(self, item) };
        if !is_test_only(&function.attrs) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_attribute(&mut self, attribute: &'a syn::Attribute) {
        if let syn::Meta::List(list) = &attribute.meta {
            let mut inner = Self::default();
            inner.scan(list.tokens.clone());
            self.texts.append(&mut inner.texts);
        }
    }

    fn visit_lit_str(&mut self, text: &'a syn::LitStr) {
        self.texts.push(Word { text: text.value(), line: line(text.span()) });
    }

    fn visit_item_mod(&mut self, module: &'a syn::ItemMod) {
        self.modules.push(Word { text: module.ident.to_string(), line: line(module.ident.span()) });
        let inner = usize::from(module.content.is_some());
        self.inline += inner;
        visit::visit_item_mod(self, module);
        self.inline -= inner;
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        self.add_tree(&item.tree, &[], !matches!(item.vis, syn::Visibility::Inherited));
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let segments = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        self.add(segments, line(syn::spanned::Spanned::span(path)));
        visit::visit_path(self, path);
    }

    fn visit_expr_method_call(&mut self, call: &'a syn::ExprMethodCall) {
        self.methods.push(Word { text: call.method.to_string(), line: line(call.method.span()) });
        visit::visit_expr_method_call(self, call);
    }

    fn visit_macro(&mut self, call: &'a syn::Macro) {
        if let Some(last) = call.path.segments.last() {
            self.macros.push(Word { text: last.ident.to_string(), line: line(last.ident.span()) });
        }
        self.scan(call.tokens.clone());
        visit::visit_macro(self, call);
    }
}

fn line(span: proc_macro2::Span) -> usize {
    span.start().line
}

/// `#[cfg(test)]`, `#[cfg(all(test, …))]`, `#[test]`: what follows is not in the library.
fn is_test_only(attributes: &[syn::Attribute]) -> bool {
    let texts = attributes.iter().map(|attribute| quote_free(&attribute.meta));
    texts.into_iter().any(|text| text == "test" || text == "cfg(test)" || text.starts_with("cfg(all(test,"))
}

/// An attribute without its spaces.
fn quote_free(meta: &syn::Meta) -> String {
    let name = |path: &syn::Path| path.segments.iter().map(|segment| segment.ident.to_string()).collect::<String>();
    match meta {
        syn::Meta::Path(path) => name(path),
        syn::Meta::List(list) => format!("{}({})", name(&list.path), list.tokens).replace(' ', ""),
        syn::Meta::NameValue(pair) => name(&pair.path),
    }
}

/// The attributes of an item.
fn attributes(item: &syn::Item) -> &[syn::Attribute] {
    match item {
        syn::Item::Const(item) => &item.attrs,
        syn::Item::Enum(item) => &item.attrs,
        syn::Item::ExternCrate(item) => &item.attrs,
        syn::Item::Fn(item) => &item.attrs,
        syn::Item::ForeignMod(item) => &item.attrs,
        syn::Item::Impl(item) => &item.attrs,
        syn::Item::Macro(item) => &item.attrs,
        syn::Item::Mod(item) => &item.attrs,
        syn::Item::Static(item) => &item.attrs,
        syn::Item::Struct(item) => &item.attrs,
        syn::Item::Trait(item) => &item.attrs,
        syn::Item::TraitAlias(item) => &item.attrs,
        syn::Item::Type(item) => &item.attrs,
        syn::Item::Union(item) => &item.attrs,
        syn::Item::Use(item) => &item.attrs,
        _ => &[],
    }
}
