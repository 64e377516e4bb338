#pragma once

#include "vrml/printing/scene_printer.h"

namespace gs::vrml {

/// Printer of the JSON encoding of X3D (ISO/IEC 19776-5).
class JsonPrinter final : public ScenePrinter {
 public:
  using ScenePrinter::ScenePrinter;

 protected:
  void begin_text(const TextHead& head) override;
  void end_text() override;
  void begin_statement(bool first, bool is_route) override;
  void end_statement() override {}
  void put_node(const WrittenNode& node, std::string_view field) override;
  void put_use(const NodeType& type, std::string_view name, std::string_view field) override;
  void put_null() override { out() += "{}"; }
  void put_prototype(const NodeType& type) override;
  void put_route(const NamedRoute& route) override;
  void put_import(const SharedName& shared) override;
  void put_export(const SharedName& shared) override;

 private:
  void put_head(const TextHead& head);
  void open(char bracket);
  void close(char bracket);
  void put_comma();
  void put_key(std::string_view mark, std::string_view key);
  void put_text(std::string_view key, std::string_view text);
  void put_value(std::string_view key, const FieldValue& value);
  void begin_object(std::string_view element);
  void end_object();
  void put_nodes(const WrittenField& field, std::string_view key, bool is_list);
  void put_declarations(const WrittenNode& node);
  void put_declaration(const WrittenField& field, bool declares);
  void put_connections(const WrittenNode& node);
  void put_program(const WrittenField& field);
  void put_interface(const NodeType& type);

  bool empty_ = true;  // the innermost object or array has no members yet
};

}  // namespace gs::vrml
