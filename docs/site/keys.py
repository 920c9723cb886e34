"""Keys of files and answers from the types that serde reads and writes: a page of tables, and a JSON Schema of each."""
import json
import re

BEGINS = re.compile(r"(?:pub(?:\([a-z]+\))? )?(struct|enum) (\w+) \{")
NUMBERS = {"f64": "number", "Number": "number", "usize": "integer", "u64": "integer", "u32": "integer", "Seed": "integer"}
# Heading, type, and what it is the text of.
ROOTS = [
    ("study.toml", "StudyPlan", "The plan of `armid study`."),
    ("robot.toml", "RobotTable", "A robot by its Denavit–Hartenberg table. [Robot files](../models/README.md) says what each key means."),
    ("ros2", "LinkSettings", "The table `[ros2]` of `experiment.toml`."),
    ("guard", "GuardSettings", "The table `[guard]` of `experiment.toml`."),
    ("estimate", "Estimate", "The JSON of `armid identify`. [JSON of an estimate](json.md) lists what the command adds."),
]


def words(lines):
    """The comment of an item, without marks of links."""
    text = " ".join(re.findall(r"^\s*/// ?(.*)$", lines, re.M)).split("  ")[0]
    return re.sub(r"\[(`?[^\]`]*`?)\](?:\([^)]*\))?", lambda m: m[1].replace("crate::", ""), text) if "](" in text or "[`" in text else text


def kebab(name):
    return re.sub(r"(?<!^)(?=[A-Z])", "-", name).lower()


class Types:
    def __init__(self, root):
        self.items = {}
        for path in sorted(root.glob("**/src/**/*.rs")):
            if "target" in path.parts or "third_party" in path.parts or path.name == "urdf_robot.rs":
                continue
            head, begun = "", None
            for line in path.read_text().splitlines(keepends=True):
                if begun is not None:
                    if line.startswith("}"):
                        kind, name, head_of, body = begun
                        self.items.setdefault(name, (kind, head_of, "".join(body)))
                        begun, head = None, ""
                    else:
                        begun[3].append(line)
                elif line.startswith(("///", "#[")):
                    head += line
                elif (start := BEGINS.match(line)) and "Deserialize" in head:
                    begun = (start[1], start[2], head, [])
                else:
                    head = ""

    def fields(self, name):
        """Key, type, comment and whether it may be left out, of each field that serde knows."""
        _, head, body = self.items[name]
        left_out = re.search(r"serde\([^)]*\bdefault\b", head) is not None
        above = ""
        for line in body.splitlines():
            field = re.match(r"    (?:pub(?:\([a-z]+\))? )?(\w+): (.*),$", line)
            if not field:
                above += line + "\n"
                continue
            key, kind = field.groups()
            serde = " ".join(re.findall(r"serde\((.*)\)", above))
            if not re.search(r"\bskip\b", serde):
                renamed = re.search(r'\brename = "([^"]*)"', serde)
                optional = left_out or kind.startswith("Option<") or re.search(r"\bdefault\b|skip_serializing_if", serde) is not None
                yield (renamed[1] if renamed else key), kind, words(above), optional
            above = ""

    def schema(self, kind, seen=()):
        """The JSON Schema of a Rust type; what has a form of its own is left open."""
        kind = kind.strip()
        if outer := re.fullmatch(r"(Option|Box|Spanned|Arc)<(.*)>", kind):
            found = self.schema(outer[2], seen)
            # JSON writes null for what is not there.
            return {**found, "type": [found["type"], "null"]} if outer[1] == "Option" and isinstance(found.get("type"), str) else found
        if outer := re.fullmatch(r"Vec<(.*)>|\[(.*); \w+\]", kind):
            return {"type": "array", "items": self.schema(outer[1] or outer[2], seen)}
        if outer := re.fullmatch(r"BTreeMap<[^,]*, (.*)>", kind):
            return {"type": "object", "additionalProperties": self.schema(outer[1], seen)}
        if kind == "Row":
            return {"type": "array", "items": {"type": "number"}}
        if kind in NUMBERS:
            return {"type": NUMBERS[kind]}
        if kind in ("String", "&'static str"):
            return {"type": "string"}
        if kind == "bool":
            return {"type": "boolean"}
        if kind not in self.items or kind in seen:
            return {}
        shape, head, body = self.items[kind]
        if shape == "enum":
            variants, above = [], ""
            for line in body.splitlines():
                if variant := re.match(r"    (\w+)(,| |\()", line):
                    variants.append((above, variant[1], variant[2]))
                    above = ""
                else:
                    above += line
            if "untagged" in head or any(end != "," for _, _, end in variants):
                return {}
            styles = {"kebab-case": kebab, "snake_case": lambda name: kebab(name).replace("-", "_"), "lowercase": str.lower}
            style = next((styles[name] for name in styles if f'rename_all = "{name}"' in head), str)
            renamed = [re.search(r'rename = "([^"]*)"', lines) for lines, _, _ in variants]
            return {"enum": [new[1] if new else style(name) for new, (_, name, _) in zip(renamed, variants)]}
        if re.search(r"remote|from =|into =|transparent", head) and kind not in (root for _, root, _ in ROOTS):
            return {}
        fields = list(self.fields(kind))
        found = {
            "type": "object",
            "properties": {key: {**self.schema(of, (*seen, kind)), **({"description": said} if said else {})} for key, of, said, _ in fields},
            "required": [key for key, _, _, optional in fields if not optional],
        }
        return {**found, "additionalProperties": False} if "deny_unknown_fields" in head else found


def kind_of(schema):
    """The type of what is not null."""
    kind = schema.get("type")
    return kind[0] if isinstance(kind, list) else kind


def written(schema):
    """A type in words."""
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    kind = kind_of(schema)
    if kind == "array":
        of = written(schema["items"])
        return f"list of {of}" if of else "list"
    if kind == "object":
        return "table"
    return {"string": "text", "boolean": "`true` or `false`", "integer": "whole number"}.get(kind, kind or "")


def rows(schema, before=""):
    """Key, type, need and meaning of each key, those of tables behind their table."""
    for key, value in schema["properties"].items():
        inner = value["items"] if kind_of(value) == "array" else value
        yield f"{before}{key}", written(value), "yes" if key in schema["required"] else "", value.get("description", "").replace("|", r"\|")
        if "properties" in inner:
            yield from rows(inner, f"{before}{key}.")


def schemas(root):
    """Name of a file, heading, sentence and JSON Schema of each root."""
    types = Types(root)
    for heading, name, sentence in ROOTS:
        schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": heading, **types.schema(name)}
        if len(schema.get("properties", {})) < 5:
            raise SystemExit(f"{name}: found {len(schema.get('properties', {}))} keys, expected the fields of a type that serde reads")
        yield f"{heading.split('.')[0]}.schema.json", heading, sentence, schema


def undocumented(root):
    """Keys of robot files that the page on robot files does not name."""
    page = set(re.findall(r"\w+", (root / "models/README.md").read_text()))
    return [key for key, *_ in rows(Types(root).schema("RobotTable")) if key.split(".")[-1] not in page]


def write(root, folder):
    """The schemas, and the page that links to them."""
    if missing := undocumented(root):
        raise SystemExit(f"models/README.md: found no line on {', '.join(missing)}, expected one on every key")
    out = ["# Keys of files and answers", "Each key with its type, as armid reads or writes it. A key that is needed has no default."]
    for file, heading, sentence, schema in schemas(root):
        (folder / file).write_text(json.dumps(schema, indent=2, ensure_ascii=False) + "\n")
        lines = [(f"`{key}`", *others) for key, *others in rows(schema)]
        columns = 4 if any(line[3] for line in lines) else 3
        lines = [("key", "type", "needed", "meaning"), ("---",) * 4, *lines]
        table = "\n".join(f"| {' | '.join(line[:columns])} |" for line in lines)
        out += [f"## {heading}", f"{sentence} [JSON Schema]({file}).", table]
    (folder / "keys.md").write_text("\n\n".join(out) + "\n")
