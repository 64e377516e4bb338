#pragma once

#include "base/noncopyable.h"

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Properties of a scene that a text in another language or encoding does not keep, with their numbers. One thread.
class PrintLosses : NonCopyable {
 public:
  /// Counts one loss. `what` completes "3 x ...".
  void add(std::string what) { ++counts_[std::move(what)]; }
  /// Returns the losses as messages for the user, sorted.
  [[nodiscard]] std::vector<std::string> messages() const {
    std::vector<std::string> texts;
    for (const auto& [what, count] : counts_)
      texts.push_back(count == 1 ? what : what + " (" + std::to_string(count) + " times)");
    return texts;
  }

 private:
  std::map<std::string, std::size_t> counts_;
};

}  // namespace gs::vrml
