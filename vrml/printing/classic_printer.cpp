#include "vrml/printing/classic_printer.h"

#include "vrml/printing/value_text.h"

#include <algorithm>

namespace gs::vrml {
namespace {

// Reports whether VRML97 has a field type (clause 5).
bool is_vrml97_type(FieldType type) {
  switch (type) {
    case FieldType::SFBool:
    case FieldType::SFColor:
    case FieldType::SFFloat:
    case FieldType::SFImage:
    case FieldType::SFInt32:
    case FieldType::SFNode:
    case FieldType::SFRotation:
    case FieldType::SFString:
    case FieldType::SFTime:
    case FieldType::SFVec2f:
    case FieldType::SFVec3f:
    case FieldType::MFColor:
    case FieldType::MFFloat:
    case FieldType::MFInt32:
    case FieldType::MFNode:
    case FieldType::MFRotation:
    case FieldType::MFString:
    case FieldType::MFTime:
    case FieldType::MFVec2f:
    case FieldType::MFVec3f:
      return true;
    default:
      return false;
  }
}

// Reports whether a field fits into the line of its node: one value without nodes.
bool is_short(const WrittenField& field) {
  constexpr std::size_t kLongest = 40;  // bytes of a text
  if (field.declares || !field.is.empty() || !field.value || field.has_nodes()) return false;
  if (const auto* const text = std::get_if<SFString>(field.value)) return text->view().size() <= kLongest;
  const FieldType type = type_of(*field.value);
  return !is_multiple(type) && type != FieldType::SFImage;
}

}  // namespace

void ClassicPrinter::begin_text(const TextHead& head) {
  if (head.grammar == Grammar::vrml97) {
    out() += "#VRML V2.0 utf8\n\n";
    return;
  }
  out() += "#X3D V" + head.version_text() + " utf8\n\nPROFILE " + head.profile + '\n';
  for (const X3DStatements::Component& each : head.components)
    out() += "COMPONENT " + each.name + ':' + std::to_string(each.level) + '\n';
  for (const X3DStatements::Unit& each : head.units) {
    out() += "UNIT " + each.category + ' ' + each.name + ' ';
    append_number<Notation::classic>(out(), each.factor);
    out() += '\n';
  }
  for (const X3DStatements::Meta& each : head.metas) {
    append_quoted(out() += "META ", each.name);
    append_quoted(out() += ' ', each.content);
    out() += '\n';
  }
  out() += '\n';
}

void ClassicPrinter::begin_statement(bool first, bool is_route) {
  if (!first && !is_route) out() += '\n';
  output().indent(levels());
}

void ClassicPrinter::put_use(const NodeType& type, std::string_view name, std::string_view field) {
  (void)type, (void)field;
  out() += "USE ";
  out() += name;
}

void ClassicPrinter::put_access(const InterfaceDeclaration& declaration) {
  if (translator().language() == Language::vrml97 && !is_vrml97_type(declaration.type))
    translator().add_loss("the type " + std::string(name_of(declaration.type)) +
                          " of X3D is kept; other VRML97 browsers do not support it");
  out() += name_of(declaration.access, translator().language());
  out() += ' ';
  out() += name_of(declaration.type);
  out() += ' ';
}

void ClassicPrinter::put_node(const WrittenNode& node, std::string_view field) {
  (void)field;
  if (!node.name.empty()) {
    out() += "DEF ";
    out() += node.name;
    out() += ' ';
  }
  out() += node.type->name;
  out() += " {";
  if (fits_line(node)) {
    for (const WrittenField& each : node.fields) {
      put_words({" ", each.name, " "});
      put_field(each);
    }
    out() += " }";
    return;
  }
  add_levels(1);
  for (const WrittenField& each : node.fields) {
    start_line();
    if (each.declares) put_access(*each.declaration);
    out() += each.name;
    if (!each.is.empty()) {
      out() += " IS ";
      out() += each.is;
    } else if (each.value || each.made) {
      out() += ' ';
      put_field(each);
    }
    output().drain();
  }
  remove_levels(1);
  if (!node.fields.empty()) start_line();
  out() += '}';
}

// Reports whether a node is written in one line: it has one short value, or few of them beside a USE.
bool ClassicPrinter::fits_line(const WrittenNode& node) {
  constexpr std::size_t kMaxFields = 3;
  const auto is_use = [this](const WrittenField& field) { return scope().has_one_use(field); };
  const bool any_use = std::any_of(node.fields.begin(), node.fields.end(), is_use);
  return !node.fields.empty() && node.fields.size() <= (any_use ? kMaxFields : 1) &&
         std::all_of(node.fields.begin(), node.fields.end(),
                     [&](const WrittenField& field) { return is_short(field) || is_use(field); });
}

void ClassicPrinter::put_field(const WrittenField& field) {
  if (!field.has_nodes()) return append_value<Notation::classic>(output(), *field.value, levels());
  if (field.made || std::holds_alternative<SFNode>(*field.value)) {
    if (field.made || scope().has_children(field))
      put_children(field, field.name, [] {});
    else
      put_null();
    return;
  }
  if (!scope().has_children(field)) {
    out() += "[]";
    return;
  }
  // A list of one node needs no brackets (VRML97 Annex A.3).
  if (scope().has_one_child(field)) return put_children(field, field.name, [] {});
  out() += '[';
  add_levels(1);
  put_children(field, field.name, [&] {
    start_line();
    output().drain();
  });
  remove_levels(1);
  start_line();
  out() += ']';
}

void ClassicPrinter::put_prototype(const NodeType& type) {
  const bool external = type.kind == NodeType::Kind::external_prototype;
  out() += (external ? "EXTERNPROTO " : "PROTO ") + type.name + " [";
  add_levels(1);
  for (const InterfaceDeclaration& declaration : type.interfaces) {
    start_line();
    put_access(declaration);
    out() += declaration.name;
    if (declaration.slot < 0 || external) continue;
    out() += ' ';
    FieldValue moved;
    put_field(default_value(type, declaration, moved));
    output().drain();
  }
  remove_levels(1);
  start_line();
  out() += ']';
  if (external) {
    out() += ' ';
    const auto urls = translator().moved_urls(type.url);
    append_value<Notation::classic>(output(), urls ? *urls : type.url, levels());
    return;
  }
  out() += " {\n";
  add_levels(1);
  put_body(type);
  remove_levels(1);
  output().indent(levels());
  out() += '}';
}

void ClassicPrinter::put_words(std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words) out() += word;
}

void ClassicPrinter::put_route(const NamedRoute& route) {
  put_words({"ROUTE ", route.from, ".", route.event_out, " TO ", route.to, ".", route.event_in});
}

void ClassicPrinter::put_import(const SharedName& shared) {
  put_words({"IMPORT ", shared.inline_name, ".", shared.exported});
  if (shared.local != shared.exported) put_words({" AS ", shared.local});
}

void ClassicPrinter::put_export(const SharedName& shared) {
  put_words({"EXPORT ", shared.local});
  if (shared.local != shared.exported) put_words({" AS ", shared.exported});
}

}  // namespace gs::vrml
