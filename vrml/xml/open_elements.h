#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml::xml {

/// Stack of open elements. Expat checks the end tags of the elements that it has seen. The stack has the names of the
/// others. One thread.
class OpenElements {
 public:
  [[nodiscard]] bool empty() const { return starts_.empty(); }
  /// Reports whether Expat has seen the start tag of the innermost element.
  [[nodiscard]] bool is_in_expat() const { return starts_.back() == kInExpat; }
  /// Returns the name of the innermost element, which Expat has not seen.
  [[nodiscard]] std::string_view name() const { return std::string_view(names_).substr(starts_.back()); }

  void open(std::string_view name) {
    starts_.push_back(names_.size());
    names_ += name;
  }
  void open_in_expat() { starts_.push_back(kInExpat); }
  void close() {
    if (!is_in_expat()) names_.resize(starts_.back());
    starts_.pop_back();
  }

 private:
  static constexpr std::size_t kInExpat = std::string::npos;

  std::vector<std::size_t> starts_;  // offsets in `names_`
  std::string names_;
};

}  // namespace gs::vrml::xml
