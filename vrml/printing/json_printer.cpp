#include "vrml/printing/json_printer.h"

#include "vrml/printing/value_text.h"

#include <algorithm>

namespace gs::vrml {
namespace {

// Reports whether a field has the program of a Script as its only URL.
bool is_program(const WrittenNode& node, const WrittenField& field) {
  if (node.type->kind != NodeType::Kind::script || field.declares || !field.is_plain()) return false;
  const auto* const urls = std::get_if<MFString>(field.value);
  return urls && urls->size() == 1 && is_program_url((*urls)[0].view());
}

}  // namespace

// Notation ----------------------------------------------------------------------------------------

void JsonPrinter::open(char bracket) {
  out() += bracket;
  add_levels(1);
  empty_ = true;
}

void JsonPrinter::close(char bracket) {
  remove_levels(1);
  if (!empty_) start_line();
  out() += bracket;
  empty_ = false;
  output().drain();
}

// Starts a member of an object or array.
void JsonPrinter::put_comma() {
  if (!empty_) out() += ',';
  empty_ = false;
  start_line();
}

void JsonPrinter::put_key(std::string_view mark, std::string_view key) {
  put_comma();
  append_json(out(), std::string(mark) + std::string(key));
  out() += ": ";
}

void JsonPrinter::put_text(std::string_view key, std::string_view text) {
  put_key("@", key);
  append_json(out(), text);
}

void JsonPrinter::put_value(std::string_view key, const FieldValue& value) {
  put_key("@", key);
  append_value<Notation::json>(output(), value, levels());
}

void JsonPrinter::begin_object(std::string_view element) {
  out() += "{ ";
  append_json(out(), element);
  out() += ": ";
  open('{');
}

void JsonPrinter::end_object() {
  close('}');
  out() += " }";
}

// Statements --------------------------------------------------------------------------------------

void JsonPrinter::begin_text(const TextHead& head) {
  const std::string version = head.version_text();
  begin_object("X3D");
  put_comma();
  out() += "\"encoding\": \"UTF-8\"";
  put_text("profile", head.profile);
  put_text("version", version);
  put_text("xsd:noNamespaceSchemaLocation", "https://www.web3d.org/specifications/x3d-" + version + ".xsd");
  put_comma();
  out() += "\"JSON schema\": \"https://www.web3d.org/specifications/x3d-" + version + "-JSONSchema.json\"";
  put_head(head);
  put_key({}, "Scene");
  open('{');
  put_key("-", "children");
  open('[');
}

void JsonPrinter::put_head(const TextHead& head) {
  if (head.components.empty() && head.units.empty() && head.metas.empty()) return;
  const auto array = [&](std::string_view key, const auto& entries, const auto& put_entry) {
    if (entries.empty()) return;
    put_key({}, key);
    open('[');
    for (const auto& each : entries) {
      put_comma();
      open('{');
      put_entry(each);
      close('}');
    }
    close(']');
  };
  put_key({}, "head");
  open('{');
  array("component", head.components, [&](const X3DStatements::Component& each) {
    put_text("name", each.name);
    put_value("level", SFInt32{each.level});
  });
  array("unit", head.units, [&](const X3DStatements::Unit& each) {
    put_text("category", each.category);
    put_text("name", each.name);
    put_value("conversionFactor", SFTime{each.factor});
  });
  array("meta", head.metas, [&](const X3DStatements::Meta& each) {
    put_text("name", each.name);
    put_text("content", each.content);
  });
  close('}');
}

void JsonPrinter::end_text() {
  close(']');
  close('}');
  end_object();
  out() += '\n';
}

void JsonPrinter::begin_statement(bool first, bool is_route) {
  (void)first, (void)is_route;
  put_comma();
}

void JsonPrinter::put_route(const NamedRoute& route) {
  begin_object("ROUTE");
  put_text("fromNode", route.from);
  put_text("fromField", route.event_out);
  put_text("toNode", route.to);
  put_text("toField", route.event_in);
  end_object();
}

void JsonPrinter::put_import(const SharedName& shared) {
  begin_object("IMPORT");
  put_text("inlineDEF", shared.inline_name);
  put_text("importedDEF", shared.exported);
  put_text("AS", shared.local);
  end_object();
}

void JsonPrinter::put_export(const SharedName& shared) {
  begin_object("EXPORT");
  put_text("localDEF", shared.local);
  put_text("AS", shared.exported);
  end_object();
}

// Nodes -------------------------------------------------------------------------------------------

void JsonPrinter::put_use(const NodeType& type, std::string_view name, std::string_view field) {
  (void)field;
  begin_object(translator().element_of(type));
  if (translator().is_declared(type)) put_text("name", type.name);
  put_text("USE", name);
  end_object();
}

void JsonPrinter::put_node(const WrittenNode& node, std::string_view field) {
  (void)field;
  begin_object(translator().element_of(*node.type));
  if (translator().is_declared(*node.type)) put_text("name", node.type->name);
  if (!node.name.empty()) put_text("DEF", node.name);
  put_declarations(node);
  put_connections(node);
  if (!translator().is_declared(*node.type))
    for (const WrittenField& each : node.fields) {
      if (each.declares || !each.is.empty()) continue;
      if (is_program(node, each))
        put_program(each);
      else if (each.has_nodes())
        put_nodes(each, each.name, each.declaration->type == FieldType::MFNode);
      else
        put_value(each.name, *each.value);
    }
  end_object();
}

// Writes nodes as a member "-key": an array, or one object.
void JsonPrinter::put_nodes(const WrittenField& field, std::string_view key, bool is_list) {
  if (!is_list) {
    if (!scope().has_children(field)) return;
    put_key("-", key);
    put_children(field, field.name, [] {});
    empty_ = false;
    return;
  }
  put_key("-", key);
  open('[');
  if (scope().has_children(field)) put_children(field, field.name, [&] { put_comma(); });
  close(']');
}

// Writes the declarations of a Script, or the values of an instance.
void JsonPrinter::put_declarations(const WrittenNode& node) {
  const bool instance = translator().is_declared(*node.type);
  const auto is_listed = [&](const WrittenField& field) { return field.declares || (instance && field.is.empty()); };
  if (std::none_of(node.fields.begin(), node.fields.end(), is_listed)) return;
  put_key({}, instance ? "fieldValue" : "field");
  open('[');
  for (const WrittenField& each : node.fields)
    if (is_listed(each)) put_declaration(each, !instance);
  close(']');
}

void JsonPrinter::put_declaration(const WrittenField& field, bool declares) {
  put_comma();
  open('{');
  put_text("name", field.name);
  if (declares) {
    put_text("accessType", name_of(field.declaration->access, translator().language()));
    put_text("type", name_of(field.declaration->type));
  }
  if (field.is_plain())
    put_value("value", *field.value);
  else if (field.is.empty() && field.has_nodes())
    put_nodes(field, "children", true);
  close('}');
}

void JsonPrinter::put_connections(const WrittenNode& node) {
  const auto is_connected = [](const WrittenField& field) { return !field.is.empty(); };
  if (std::none_of(node.fields.begin(), node.fields.end(), is_connected)) return;
  put_key({}, "IS");
  open('{');
  put_key({}, "connect");
  open('[');
  for (const WrittenField& each : node.fields) {
    if (!is_connected(each)) continue;
    put_comma();
    open('{');
    put_text("nodeField", each.name);
    put_text("protoField", each.is);
    close('}');
  }
  close(']');
  close('}');
}

// Writes the program of a Script as an array of lines.
void JsonPrinter::put_program(const WrittenField& field) {
  std::string_view program = trimmed_program(std::get<MFString>(*field.value)[0].view());
  put_key("#", "sourceCode");
  open('[');
  while (true) {
    const std::size_t end = program.find('\n');
    put_comma();
    append_json(out(), program.substr(0, end));
    if (end == std::string_view::npos) break;
    program.remove_prefix(end + 1);
  }
  close(']');
}

// PROTOs ------------------------------------------------------------------------------------------

void JsonPrinter::put_interface(const NodeType& type) {
  if (type.interfaces.empty()) return;
  put_key({}, "field");
  open('[');
  for (const InterfaceDeclaration& declaration : type.interfaces) {
    FieldValue moved;
    WrittenField field{&declaration, declaration.name};
    if (type.kind == NodeType::Kind::prototype) field = default_value(type, declaration, moved);
    put_declaration(field, true);
  }
  close(']');
}

void JsonPrinter::put_prototype(const NodeType& type) {
  const bool external = type.kind == NodeType::Kind::external_prototype;
  begin_object(external ? "ExternProtoDeclare" : "ProtoDeclare");
  put_text("name", type.name);
  if (external) {
    const auto urls = translator().moved_urls(type.url);
    put_value("url", urls ? *urls : type.url);
    put_interface(type);
  } else {
    if (!type.interfaces.empty()) {
      put_key({}, "ProtoInterface");
      open('{');
      put_interface(type);
      close('}');
    }
    put_key({}, "ProtoBody");
    open('{');
    put_key("-", "children");
    open('[');
    put_body(type);
    close(']');
    close('}');
  }
  end_object();
}

}  // namespace gs::vrml
