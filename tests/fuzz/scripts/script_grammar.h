#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace gs::fuzz {

/// Pseudo-random numbers, equal on all machines (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next();
  /// Returns an integer in [0, end).
  int below(int end) { return static_cast<int>(next() % static_cast<std::uint64_t>(end)); }
  /// Returns true in one of `turns` calls, on average.
  bool once_in(int turns) { return below(turns) == 0; }
  std::string pick(std::initializer_list<const char*> texts);

 private:
  std::uint64_t state_;
};

/// Generator of programs for hostile Scripts. Each statement has an own line, so that a world can be minimised by
/// lines. Programs use only single quotes, because they are inside of VRML strings.
class ScriptGrammar {
 public:
  /// Prepares a generator that appends to `out`. Each bit of `kinds` permits a kind of statement. If some kinds are
  /// missing, the other kinds reach more code.
  ScriptGrammar(Random& random, std::string& out, std::uint64_t kinds) : random_(random), out_(out), kinds_(kinds) {}

  /// Appends a complete program: variables, helper functions and event handlers.
  void program();
  /// Returns the URL of a world or a program. The file may not exist.
  std::string url();

 private:
  void line(const std::string& text);
  void block(int most = 3);
  void statement();
  void simple();
  void assignment();
  void node_write();
  void list_call();
  void browser_call();
  void contact_call();
  void later();
  void abuse();
  void function(const std::string& head, const std::string& tail, const std::string& result);
  void nested_script();

  std::string number();
  std::string text();
  std::string vector();
  std::string node();
  std::string list();
  std::string any();
  std::string hostile();
  std::string hostile_array();
  std::string nodes_text();
  std::string quoted(const std::string& words) const { return quote_ + words + quote_; }
  std::string fresh() { return "h" + std::to_string(names_++); }
  std::string kept() { return "kept(" + std::to_string(random_.below(12)) + ")"; }

  enum Kind { kFirstRare = 16, kReplaceWorld = kFirstRare, kLoadUrl, kSetUrl, kThrow, kPrototypes };
  [[nodiscard]] bool has(int kind) const { return (kinds_ >> kind & 1) != 0; }

  static constexpr int kDeepest = 3;

  Random& random_;
  std::string& out_;
  std::uint64_t kinds_;
  std::string quote_ = "'";
  int depth_ = 0, names_ = 0, endless_ = 0;
  bool nested_ = false;  // the text is inside the program of a nested Script
};

}  // namespace gs::fuzz
