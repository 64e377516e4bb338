#include "vrml/syntax/printer.h"

#include "vrml/scene/field_numbers.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::vrml {
namespace {

constexpr std::size_t kLineWidth = 100;
constexpr std::size_t kPiece = std::size_t{1} << 20;
// Maximum indentation, in blanks. With a thousand levels, most of the text would be blanks otherwise.
constexpr std::size_t kMaxIndent = 80;
// Maximum depth, higher than in parsed files. Only scenes with unusual USEs reach it.
constexpr int kMaxDepth = 8000;

/// Function that writes and clears the text printed so far when it is large. Null means that all text is collected.
using Drain = std::function<void(std::string& out)>;

std::string deeper(const std::string& indent) { return indent.size() < kMaxIndent ? indent + "  " : indent; }

template <class Number>
void print_number(std::string& out, Number number) {
  char digits[64];
  const auto result = std::to_chars(digits, digits + sizeof digits, number);
  out.append(digits, result.ptr);
}

void print_string(std::string& out, std::string_view text) {
  out += '"';
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  out += '"';
}

template <NumberElement T>
void print_element(std::string& out, const T& element) {
  const auto* const numbers = numbers_of(element);
  for (int i = 0; i < ElementNumbers<T>::kCount; ++i) {
    if (i > 0) out += ' ';
    print_number(out, numbers[i]);
  }
}
void print_element(std::string& out, SFBool value) { out += value ? "TRUE" : "FALSE"; }
void print_element(std::string& out, const SFString& value) { print_string(out, value.view()); }

void print_element(std::string& out, const SFImage& image, const Drain& drain = {}) {
  print_number(out, image.width());
  out += ' ';
  print_number(out, image.height());
  out += ' ';
  print_number(out, image.components());
  for (const std::uint32_t pixel : image.pixels()) {
    char digits[16];
    const auto result = std::to_chars(digits, digits + sizeof digits, pixel, 16);
    out += " 0x";
    out.append(digits, result.ptr);
    if (drain && out.size() > kPiece) drain(out);
  }
}

// Prints the elements of a list in lines of readable length.
template <class T>
void print_list(std::string& out, const Array<T>& list, const std::string& indent, const Drain& drain) {
  if (list.empty()) {
    out += "[]";
    return;
  }
  constexpr bool kPlain = ElementNumbers<T>::kCount == 1 || std::is_same_v<T, SFBool>;
  const char* separator = kPlain ? " " : ", ";
  std::string line;
  const std::size_t start = out.size();
  out += "[ ";
  std::size_t line_start = start;
  bool broken = false;
  for (std::size_t i = 0; i < list.size(); ++i) {
    line.clear();
    print_element(line, list[i]);
    if (i > 0) {
      out += separator;
      if (out.size() - line_start + line.size() > kLineWidth) {
        while (out.back() == ' ') out.pop_back();
        if (drain && out.size() > kPiece) drain(out);
        out += '\n' + deeper(indent);
        line_start = out.size();
        broken = true;
      }
    }
    out += line;
  }
  out += broken ? "\n" + indent + "]" : " ]";
}

class Printer {
 public:
  Printer(const SceneGraph& scene, std::string& out, const Drain& drain) : scene_(scene), out_(out), drain_(drain) {}

  void print_scope(const std::vector<Statement>& statements, const NodeType* prototype, const std::string& indent) {
    prototype_ = prototype;
    for (const Statement& statement : statements) {
      if (statement.kind == Statement::Kind::node) count(statement.node);
      if (statement.kind == Statement::Kind::route) {
        needs_name_.insert(statement.route.from.index);
        needs_name_.insert(statement.route.to.index);
      }
    }
    if (prototype)
      for (const IsMapping& mapping : prototype->prototype->mappings) mappings_[mapping.node.index].push_back(&mapping);
    bool first = true;
    for (const Statement& statement : statements) {
      if (!first && statement.kind != Statement::Kind::route) out_ += '\n';
      first = false;
      out_ += indent;
      switch (statement.kind) {
        case Statement::Kind::node:
          print_node(statement.node, indent, 0);
          break;
        case Statement::Kind::prototype:
          print_type(*statement.type, indent);
          break;
        case Statement::Kind::route:
          print_route(statement.route);
          break;
      }
      end_line();
    }
  }

 private:
  void end_line() {
    out_ += '\n';
    if (drain_ && out_.size() > kPiece) drain_(out_);
  }

  // Counts how often each node is used. Uses a list instead of recursion, so that any scene is safe.
  void count(NodeId root) {
    std::vector<NodeId> waiting{root};
    while (!waiting.empty()) {
      const NodeId id = waiting.back();
      waiting.pop_back();
      if (!scene_.contains(id)) continue;
      if (!seen_.insert(id.index).second) {
        needs_name_.insert(id.index);
        continue;
      }
      const Node& node = scene_.node(id);
      for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
        if (const auto* one = std::get_if<SFNode>(&node.values[i])) waiting.push_back(*one);
        if (const auto* many = std::get_if<MFNode>(&node.values[i]))
          for (const NodeId child : *many) waiting.push_back(child);
      }
    }
  }

  const std::string& name_of_node(NodeId id) {
    std::string& name = names_[id.index];
    if (!name.empty()) return name;
    const Node& node = scene_.node(id);
    const std::string stem = node.name.empty() ? "_" + node.type->name : std::string(node.name);
    name = stem;
    for (std::size_t& number = suffixes_[stem]; !used_.insert(name).second;)
      name = stem + "_" + std::to_string(++number);
    return name;
  }

  void print_node(NodeId id, const std::string& indent, int depth) {
    if (!scene_.contains(id) || depth > kMaxDepth) {
      out_ += "NULL";
      return;
    }
    if (printed_.contains(id.index)) {
      out_ += "USE " + name_of_node(id);
      return;
    }
    printed_.insert(id.index);
    const Node& node = scene_.node(id);
    if (!node.name.empty() || needs_name_.contains(id.index)) out_ += "DEF " + name_of_node(id) + ' ';
    out_ += node.type->name;
    bool empty = true;
    out_ += " {\n";
    const std::string inner = deeper(indent);
    const auto mapped = mappings_.find(id.index);
    const NodeType* plain = node.type->kind == NodeType::Kind::script ? &built_in_node_type(NodeKind::script) : nullptr;
    for (const InterfaceDeclaration& declaration : node.type->interfaces) {
      const IsMapping* mapping = nullptr;
      if (mapped != mappings_.end())
        for (const IsMapping* candidate : mapped->second)
          if (candidate->inner == &declaration) mapping = candidate;
      const bool own = plain && !plain->find(declaration.name);
      if (own) {
        out_ += inner + std::string(name_of(declaration.access)) + ' ' + std::string(name_of(declaration.type)) + ' ';
      } else if (!mapping &&
                 (declaration.slot < 0 || node.values[declaration.slot] == node.type->defaults[declaration.slot])) {
        continue;
      } else {
        out_ += inner;
      }
      empty = false;
      out_ += declaration.name;
      if (mapping) {
        out_ += " IS " + mapping->outer->name;
      } else if (declaration.slot >= 0) {
        out_ += ' ';
        print_field(node.values[declaration.slot], inner, depth);
      }
      end_line();
    }
    if (empty) {
      out_.pop_back();
      out_ += "}";
    } else {
      out_ += indent + "}";
    }
  }

  void print_field(const FieldValue& value, const std::string& indent, int depth) {
    std::visit(
        [&](const auto& v) {
          using T = std::decay_t<decltype(v)>;
          if constexpr (std::is_same_v<T, SFNode>) {
            print_node(v, indent, depth + 1);
          } else if constexpr (std::is_same_v<T, MFNode>) {
            if (v.empty()) {
              out_ += "[]";
              return;
            }
            out_ += "[\n";
            for (const NodeId child : v) {
              out_ += deeper(indent);
              print_node(child, deeper(indent), depth + 1);
              end_line();
            }
            out_ += indent + "]";
          } else if constexpr (requires { v.span(); }) {
            print_list(out_, v, indent, drain_);
          } else if constexpr (std::is_same_v<T, SFImage>) {
            print_element(out_, v, drain_);
          } else {
            print_element(out_, element_in(v));
          }
        },
        value);
  }

  void print_type(const NodeType& type, const std::string& indent) {
    const bool external = type.kind == NodeType::Kind::external_prototype;
    const std::string inner = deeper(indent);
    out_ += (external ? "EXTERNPROTO " : "PROTO ") + type.name + " [\n";
    for (const InterfaceDeclaration& declaration : type.interfaces) {
      out_ += inner + std::string(name_of(declaration.access)) + ' ' + std::string(name_of(declaration.type)) + ' ' +
              declaration.name;
      if (declaration.slot >= 0 && !external) {
        out_ += ' ';
        if (const auto* node = std::get_if<SFNode>(&declaration.initial)) count(*node);
        if (const auto* nodes = std::get_if<MFNode>(&declaration.initial))
          for (const NodeId child : *nodes) count(child);
        print_field(declaration.initial, inner, 0);
      }
      end_line();
    }
    out_ += indent + "]";
    if (external) {
      out_ += ' ';
      print_list(out_, type.url, indent, drain_);
      return;
    }
    out_ += " {\n";
    Printer(*type.prototype->scene, out_, drain_).print_scope(type.prototype->statements, &type, inner);
    out_ += indent + "}";
  }

  void print_route(const Route& route) {
    out_ += "ROUTE " + name_of_node(route.from) + '.' + route.event_out->name + " TO " + name_of_node(route.to) + '.' +
            route.event_in->name;
  }

  const SceneGraph& scene_;
  std::string& out_;
  const Drain& drain_;
  const NodeType* prototype_ = nullptr;
  std::unordered_set<std::uint32_t> seen_, printed_, needs_name_;
  std::unordered_map<std::uint32_t, std::string> names_;
  std::unordered_set<std::string> used_;
  std::unordered_map<std::string, std::size_t> suffixes_;
  std::unordered_map<std::uint32_t, std::vector<const IsMapping*>> mappings_;
};

}  // namespace

std::string print(const SceneGraph& scene) {
  std::string out = "#VRML V2.0 utf8\n\n";
  const Drain none;
  Printer(scene, out, none).print_scope(scene.statements(), nullptr, "");
  return out;
}

void print(const SceneGraph& scene, const std::function<bool(std::string_view)>& write) {
  std::string out = "#VRML V2.0 utf8\n\n";
  bool wanted = true;
  const Drain drain = [&](std::string& text) {
    wanted = wanted && write(text);
    text.clear();
  };
  Printer(scene, out, drain).print_scope(scene.statements(), nullptr, "");
  drain(out);
}

void print_value(std::string& out, const FieldValue& value, const SceneGraph& scene) {
  const auto node_text = [&](NodeId id) {
    if (!scene.contains(id)) return std::string("NULL");
    const Node& node = scene.node(id);
    return node.name.empty() ? node.type->name : std::string(node.name);
  };
  std::visit(
      [&](const auto& v) {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, SFNode>) {
          out += node_text(v);
        } else if constexpr (requires { v.span(); }) {
          out += "[ ";
          for (std::size_t i = 0; i < v.size(); ++i) {
            if (i) out += ", ";
            if constexpr (std::is_same_v<T, MFNode>) {
              out += node_text(v[i]);
            } else {
              print_element(out, v[i]);
            }
          }
          out += v.empty() ? "]" : " ]";
        } else {
          print_element(out, element_in(v));
        }
      },
      value);
}

std::string print_interface(const NodeType& type) {
  static const SceneGraph nothing;
  std::string out;
  for (const InterfaceDeclaration& declaration : type.interfaces) {
    if (declaration.of_other_browsers) continue;
    std::string line = "  " + std::string(name_of(declaration.access));
    line.resize(std::max<std::size_t>(line.size() + 1, 15), ' ');
    line += name_of(declaration.type);
    line.resize(std::max<std::size_t>(line.size() + 1, 26), ' ');
    line += declaration.name;
    if (declaration.slot >= 0) {
      line.resize(std::max<std::size_t>(line.size() + 1, 43), ' ');
      print_value(line, declaration.initial, nothing);
    }
    if (!declaration.range.empty()) {
      line.resize(std::max<std::size_t>(line.size() + 1, 60), ' ');
      line += "# " + declaration.range;
    }
    out += line + '\n';
  }
  return out;
}

}  // namespace gs::vrml
