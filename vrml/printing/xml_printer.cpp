#include "vrml/printing/xml_printer.h"

#include "vrml/printing/value_text.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>

namespace gs::vrml {
namespace {

constexpr std::string_view kDefaultContainer = "children";

// Returns a program with the line ends of XML (XML 1.0 2.11), which readers make of all line ends.
std::string with_line_feeds(std::string_view program) {
  std::string lines;
  for (std::size_t i = 0; i < program.size(); ++i) {
    if (program[i] != '\r')
      lines += program[i];
    else if (i + 1 == program.size() || program[i + 1] != '\n')
      lines += '\n';
  }
  return lines;
}

// Returns the program of a Script if the only URL contains it.
std::optional<std::string> only_program(const WrittenNode& node) {
  if (node.type->kind != NodeType::Kind::script) return std::nullopt;
  for (const WrittenField& field : node.fields) {
    const auto* const urls = field.value ? std::get_if<MFString>(field.value) : nullptr;
    if (!urls || field.declares || !field.is.empty() || urls->size() != 1) continue;
    const std::string_view url = (*urls)[0].view();
    if (is_program_url(url) && is_xml_text(url)) return with_line_feeds(trimmed_program(url));
  }
  return std::nullopt;
}

bool is_program_field(const WrittenField& field) {
  return !field.declares && field.value && std::holds_alternative<MFString>(*field.value);
}

}  // namespace

void XmlPrinter::put_attribute(std::string_view name, std::string_view text) {
  out() += ' ';
  out() += name;
  out() += "='";
  append_xml(out(), text);
  out() += '\'';
  if (!is_xml_text(text)) translator().add_loss("XML does not allow some characters of a text; left them out");
}

void XmlPrinter::put_value(std::string_view name, const FieldValue& value) {
  out() += ' ';
  out() += name;
  out() += "='";
  append_value<Notation::xml>(output(), value, levels());
  out() += '\'';
  output().drain();
}

void XmlPrinter::begin_text(const TextHead& head) {
  const std::string version = head.version_text();
  out() += "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE X3D PUBLIC \"ISO//Web3D//DTD X3D " + version +
           "//EN\" \"https://www.web3d.org/specifications/x3d-" + version + ".dtd\">\n<X3D";
  put_attribute("profile", head.profile);
  put_attribute("version", version);
  out() +=
      " xmlns:xsd='http://www.w3.org/2001/XMLSchema-instance'"
      " xsd:noNamespaceSchemaLocation='https://www.web3d.org/specifications/x3d-" +
      version + ".xsd'>";
  add_levels(1);
  put_head(head);
  start_line();
  out() += "<Scene>";
  add_levels(1);
}

void XmlPrinter::put_head(const TextHead& head) {
  if (head.components.empty() && head.units.empty() && head.metas.empty()) return;
  const auto element = [&](std::string_view name, std::initializer_list<std::array<std::string_view, 2>> attributes) {
    start_line();
    out() += '<';
    out() += name;
    for (const auto& [attribute, text] : attributes) put_attribute(attribute, text);
    out() += "/>";
  };
  start_line();
  out() += "<head>";
  add_levels(1);
  for (const X3DStatements::Component& each : head.components)
    element("component", {{"name", each.name}, {"level", std::to_string(each.level)}});
  for (const X3DStatements::Unit& each : head.units) {
    std::string factor;
    append_number<Notation::xml>(factor, each.factor);
    element("unit", {{"category", each.category}, {"name", each.name}, {"conversionFactor", factor}});
  }
  for (const X3DStatements::Meta& each : head.metas) element("meta", {{"name", each.name}, {"content", each.content}});
  end_element("head");
}

void XmlPrinter::end_text() {
  end_element("Scene");
  end_element("X3D");
  out() += '\n';
}

void XmlPrinter::begin_statement(bool first, bool is_route) {
  (void)first, (void)is_route;
  start_line();
}

void XmlPrinter::end_element(std::string_view element) {
  remove_levels(1);
  start_line();
  out() += "</";
  out() += element;
  out() += '>';
  output().drain();
}

void XmlPrinter::open_element(const NodeType& type) {
  out() += '<';
  out() += translator().element_of(type);
  if (translator().is_declared(type)) put_attribute("name", type.name);
}

// Writes the field of a node in its parent if it is not the default (ISO/IEC 19776-1 4.3.9).
void XmlPrinter::put_container(const NodeType& type, std::string_view field) {
  const std::string_view usual = type.container_field.empty() ? kDefaultContainer : type.container_field;
  if (!field.empty() && field != usual) put_attribute("containerField", field);
}

void XmlPrinter::put_use(const NodeType& type, std::string_view name, std::string_view field) {
  open_element(type);
  put_attribute("USE", name);
  put_container(type, field);
  out() += "/>";
}

void XmlPrinter::put_node(const WrittenNode& node, std::string_view field) {
  const NodeType& type = *node.type;
  const bool instance = translator().is_declared(*node.type);
  const std::optional<std::string> program = only_program(node);
  open_element(type);
  if (!node.name.empty()) put_attribute("DEF", node.name);
  bool has_content = program.has_value();
  for (const WrittenField& each : node.fields) {
    if (each.declares || !each.is_plain() || instance)
      has_content = true;
    else if (!program || !is_program_field(each))
      put_value(each.name, *each.value);
  }
  put_container(type, field);
  if (!has_content) {
    out() += "/>";
    return;
  }
  out() += '>';
  add_levels(1);
  put_content(node, program ? &*program : nullptr);
  end_element(translator().element_of(type));
}

// Writes the elements inside of a node. Declarations come first, because connections refer to them.
void XmlPrinter::put_content(const WrittenNode& node, const std::string* program) {
  const bool instance = translator().is_declared(*node.type);
  for (const WrittenField& each : node.fields) {
    if (each.declares)
      put_declaration("field", each, true);
    else if (instance && each.is.empty())
      put_declaration("fieldValue", each, false);
  }
  put_connections(node);
  for (const WrittenField& each : node.fields)
    if (!each.declares && !instance && each.is.empty() && each.has_nodes())
      put_children(each, each.name, [&] { start_line(); });
  if (program) put_program(*program);
}

// Writes a declaration of a Script or PROTO, or a value of an instance.
void XmlPrinter::put_declaration(std::string_view element, const WrittenField& field, bool declares) {
  start_line();
  out() += '<';
  out() += element;
  if (declares) {
    put_attribute("accessType", name_of(field.declaration->access, translator().language()));
    put_attribute("type", name_of(field.declaration->type));
  }
  put_attribute("name", field.name);
  if (field.is_plain()) put_value("value", *field.value);
  if (!field.is.empty() || !field.has_nodes() || !scope().has_children(field)) {
    out() += "/>";
    return;
  }
  out() += '>';
  add_levels(1);
  put_children(field, {}, [&] { start_line(); });
  end_element(element);
}

void XmlPrinter::put_connections(const WrittenNode& node) {
  const auto is_connected = [](const WrittenField& field) { return !field.is.empty(); };
  if (std::none_of(node.fields.begin(), node.fields.end(), is_connected)) return;
  start_line();
  out() += "<IS>";
  add_levels(1);
  for (const WrittenField& each : node.fields) {
    if (!is_connected(each)) continue;
    start_line();
    out() += "<connect";
    put_attribute("nodeField", each.name);
    put_attribute("protoField", each.is);
    out() += "/>";
  }
  end_element("IS");
}

void XmlPrinter::put_program(std::string_view program) {
  constexpr std::string_view kEnd = "]]>";
  start_line();
  out() += "<![CDATA[";
  for (std::size_t end; (end = program.find(kEnd)) != std::string_view::npos; program.remove_prefix(end + 2)) {
    out() += program.substr(0, end + 2);
    out() += "]]><![CDATA[";
  }
  out() += program;
  out() += kEnd;
}

void XmlPrinter::put_prototype(const NodeType& type) {
  const bool external = type.kind == NodeType::Kind::external_prototype;
  const std::string_view element = external ? "ExternProtoDeclare" : "ProtoDeclare";
  out() += '<';
  out() += element;
  put_attribute("name", type.name);
  if (external) {
    const auto urls = translator().moved_urls(type.url);
    put_value("url", urls ? *urls : type.url);
  }
  out() += '>';
  add_levels(1);
  if (!external && !type.interfaces.empty()) {
    start_line();
    out() += "<ProtoInterface>";
    add_levels(1);
  }
  for (const InterfaceDeclaration& declaration : type.interfaces) {
    FieldValue moved;
    WrittenField field{&declaration, declaration.name};
    if (!external) field = default_value(type, declaration, moved);
    put_declaration("field", field, true);
  }
  if (!external) {
    if (!type.interfaces.empty()) end_element("ProtoInterface");
    start_line();
    out() += "<ProtoBody>";
    add_levels(1);
    put_body(type);
    end_element("ProtoBody");
  }
  end_element(element);
}

void XmlPrinter::put_route(const NamedRoute& route) {
  out() += "<ROUTE";
  put_attribute("fromNode", route.from);
  put_attribute("fromField", route.event_out);
  put_attribute("toNode", route.to);
  put_attribute("toField", route.event_in);
  out() += "/>";
}

void XmlPrinter::put_import(const SharedName& shared) {
  out() += "<IMPORT";
  put_attribute("inlineDEF", shared.inline_name);
  put_attribute("importedDEF", shared.exported);
  put_attribute("AS", shared.local);
  out() += "/>";
}

void XmlPrinter::put_export(const SharedName& shared) {
  out() += "<EXPORT";
  put_attribute("localDEF", shared.local);
  put_attribute("AS", shared.exported);
  out() += "/>";
}

}  // namespace gs::vrml
