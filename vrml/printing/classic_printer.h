#pragma once

#include "vrml/printing/scene_printer.h"

#include <initializer_list>
#include <string_view>

namespace gs::vrml {

/// Printer of VRML97 and of the classic VRML encoding of X3D (ISO/IEC 19776-2).
class ClassicPrinter final : public ScenePrinter {
 public:
  using ScenePrinter::ScenePrinter;

 protected:
  void begin_text(const TextHead& head) override;
  void end_text() override {}
  void begin_statement(bool first, bool is_route) override;
  void end_statement() override { out() += '\n'; }
  void put_node(const WrittenNode& node, std::string_view field) override;
  void put_use(const NodeType& type, std::string_view name, std::string_view field) override;
  void put_null() override { out() += "NULL"; }
  void put_prototype(const NodeType& type) override;
  void put_route(const NamedRoute& route) override;
  void put_import(const SharedName& shared) override;
  void put_export(const SharedName& shared) override;

 private:
  [[nodiscard]] bool fits_line(const WrittenNode& node);
  void put_words(std::initializer_list<std::string_view> words);
  void put_field(const WrittenField& field);
  void put_access(const InterfaceDeclaration& declaration);
};

}  // namespace gs::vrml
