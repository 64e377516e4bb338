#pragma once

#include "base/budget.h"
#include "vrml/inventor/item.h"
#include "vrml/inventor/value_reader.h"

#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::vrml::inventor {

/// Parser of the syntax of VRML 1.0 and Inventor. The text comes in windows of whole root nodes; only the last window
/// may end inside a node. Nesting is limited by Limits::nesting. Safe for untrusted text. One thread.
class ItemParser {
 public:
  explicit ItemParser(SceneSink& sink)
      : sink_(sink), values_(lexer_, sink), share_(sink.scene().budget(), Resource::nodes) {}

  /// Sets the next window, which follows the previous one in the text. `last` means that the text ends with it.
  void set_window(std::string_view text, bool last) {
    lexer_.set_window(text.data(), text.data() + text.size(), true);
    last_window_ = last;
  }
  /// Returns the next root node of the window; null at its end.
  [[nodiscard]] ItemPtr next_root();
  /// Reports whether the text ended inside a node.
  [[nodiscard]] bool is_truncated() const { return truncated_; }
  /// Number of nodes read so far.
  [[nodiscard]] std::uint64_t count() const { return serial_; }

 private:
  [[nodiscard]] Token next();
  [[nodiscard]] char peek();
  void back(const Token& token);
  [[nodiscard]] bool is_node_start(const Token& token);
  [[nodiscard]] ItemPtr parse_node(const Token& first, std::size_t depth);
  void parse_body(Item& item, std::size_t depth);
  void parse_member(Item& item, const Token& name, std::size_t depth, std::vector<FieldRow>& own);
  void parse_field(Item& item, const FieldRow& row, std::size_t depth);
  void parse_nodes(ItemField& field, std::size_t depth);
  void parse_connection(std::size_t depth);
  void declare_fields(std::vector<FieldRow>& own);
  void read_base_types(Item& item);
  void skip_field(const Item& item, const Token& name);
  const FieldRow& keep_row(std::string_view name, const ValueType& type);
  const ItemType& type_of(const Token& name);
  [[nodiscard]] bool charge(std::size_t bytes, SourceLocation location);
  void end_inside(const Item& item);
  void report_once(SourceLocation location, std::string message, Severity severity = Severity::warning);

  SceneSink& sink_;
  Lexer lexer_;
  ValueReader values_;
  Share share_;  // memory of nodes before their conversion
  std::unordered_map<std::string, ItemPtr> names_;
  std::unordered_map<std::string, std::unique_ptr<ItemType>> unknown_types_;
  std::deque<FieldRow> rows_;  // fields without a row in the table of types
  std::unordered_map<std::string, const FieldRow*> row_by_name_;
  std::unordered_set<std::string> reported_;
  std::uint64_t serial_ = 0;
  bool last_window_ = false, truncated_ = false, stopped_ = false, rubbish_ = false;
};

}  // namespace gs::vrml::inventor
