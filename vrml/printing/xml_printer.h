#pragma once

#include "vrml/printing/scene_printer.h"

namespace gs::vrml {

/// Printer of the XML encoding of X3D (ISO/IEC 19776-1).
class XmlPrinter final : public ScenePrinter {
 public:
  using ScenePrinter::ScenePrinter;

 protected:
  void begin_text(const TextHead& head) override;
  void end_text() override;
  void begin_statement(bool first, bool is_route) override;
  void end_statement() override {}
  void put_node(const WrittenNode& node, std::string_view field) override;
  void put_use(const NodeType& type, std::string_view name, std::string_view field) override;
  void put_null() override {}
  void put_prototype(const NodeType& type) override;
  void put_route(const NamedRoute& route) override;
  void put_import(const SharedName& shared) override;
  void put_export(const SharedName& shared) override;

 private:
  void put_head(const TextHead& head);
  void put_attribute(std::string_view name, std::string_view text);
  void put_value(std::string_view name, const FieldValue& value);
  void open_element(const NodeType& type);
  void put_container(const NodeType& type, std::string_view field);
  void put_content(const WrittenNode& node, const std::string* program);
  void put_declaration(std::string_view element, const WrittenField& field, bool declares);
  void put_connections(const WrittenNode& node);
  void put_program(std::string_view program);
  void end_element(std::string_view element);
};

}  // namespace gs::vrml
