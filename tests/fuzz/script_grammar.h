#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace gs::fuzz {

/// Pseudo-random numbers that are the same on all machines (SplitMix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next();
  /// Returns an integer in [0, end).
  int below(int end) { return static_cast<int>(next() % static_cast<std::uint64_t>(end)); }
  /// Returns true once in `turns` calls on average.
  bool once_in(int turns) { return below(turns) == 0; }
  std::string pick(std::initializer_list<const char*> texts);

 private:
  std::uint64_t state_;
};

/// Generates programs of hostile Scripts. Each statement has a line of its own, so that a world shrinks by lines.
/// Programs use single quotes only, since they stand in strings of VRML.
class ScriptGrammar {
 public:
  /// `kinds`: a bit for each kind of statement that the programs of a world have; without some, others reach further.
  ScriptGrammar(Random& random, std::string& out, std::uint64_t kinds) : random_(random), out_(out), kinds_(kinds) {}

  /// Appends a whole program: variables, helpers, and callbacks.
  void program();
  /// Returns a URL of a world or a program, which may be missing.
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
  bool nested_ = false;  // in the text of a Script that a program makes
};

}  // namespace gs::fuzz
