#pragma once

#include "vrml/syntax/value_parser.h"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Reader of the statements of Annex A: nodes with their fields, PROTO, EXTERNPROTO, IS and ROUTE.
class StatementParser {
 public:
  explicit StatementParser(ParsedText& text) : text_(text), values_(text) {}

  /// Continues the construct on top of the stack.
  Step step();

 private:
  // Statements, node heads and ROUTE, in statement_parser.cpp.
  Step statement_step();
  Step statement(const Token& keyword, bool& was_statement);
  Step other_statement(const Token& keyword, bool& said);
  Step sharing_statement(const Token& keyword, bool& said);
  Step node_head(Token token, NodeTarget target);
  Step node_list_step();
  Step route_statement(SourceLocation location);
  bool read_node_event(std::string& node, std::string& event, Step& step);

  // Statements of X3D, in statement_parser_x3d.cpp.
  Step x3d_statement(const Token& keyword, bool& was_statement);
  Step component_statement(const Token& keyword);
  Step meta_statement(const Token& keyword);
  Step unit_statement(const Token& keyword);
  Step import_statement(const Token& keyword);
  Step export_statement(const Token& keyword);
  Step read_new_name(Token& name);
  Step expected(const Token& keyword, const Token& found, const Lexer::Position& before, std::string_view what);

  // PROTO and EXTERNPROTO, in statement_parser_prototypes.cpp.
  Step prototype_head(bool external);
  Step interface_step();
  Step external_url_step();

  // Node bodies, interface declarations, IS and recovery, in statement_parser_fields.cpp.
  Step node_body_step();
  Step field(Token name);
  Step value(FieldType type, FieldValue& into, std::string_view name, std::string_view restricts);
  Step is_mapping(const Token& name);
  Step interface_declaration(AccessType access, NodeType& type, bool values, bool is_allowed);
  Step skip_step();
  void skip_interface_value();

  static constexpr std::array<std::string_view, 6> kOtherStatements = {"META", "PROFILE", "COMPONENT",
                                                                       "UNIT", "IMPORT",  "EXPORT"};

  ParsedText& text_;
  ValueParser values_;
  std::vector<std::unique_ptr<InterfaceDeclaration>> kept_values_;  // values of invalid declarations
  FieldValue discarded_ = MFNode{};                                 // storage for named nodes that no field can take
  std::array<bool, kOtherStatements.size()> said_statements_{};
  bool statement_failed_ = false;  // an unusable token in a statement of X3D was reported; reading continues there
  bool said_external_value_ = false, said_route_in_list_ = false, said_null_ = false;
};

}  // namespace gs::vrml
