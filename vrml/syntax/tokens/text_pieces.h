#pragma once

#include "base/array.h"
#include "base/budget.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

namespace gs::vrml {

/// Bytes of a text that comes in pieces, until they complete a token. Charges its memory to a budget. One thread.
class TextPieces {
 public:
  explicit TextPieces(std::shared_ptr<Budget> budget) : share_(std::move(budget), Resource::nodes) {}

  /// Joins the unread bytes with bytes of the next piece until they are complete, and reads the rest of the piece in
  /// place. `read` receives a window of the text and returns the count of its bytes that it has used. Returns false if
  /// the budget has no memory for the unread bytes.
  template <class Read>
  [[nodiscard]] bool push(std::string_view piece, Read&& read) {
    while (!piece.empty()) {
      if (carry_.empty()) {
        const std::size_t used = read(piece);
        append(piece.substr(used));
        piece = {};
      } else {
        const std::size_t old_size = carry_.size();
        const std::size_t joined = std::min(piece.size(), std::max(kJoin, old_size / kRetryGrowth));
        append(piece.substr(0, joined));
        if (carry_.size() < retry_size_) {
          piece.remove_prefix(joined);
          continue;
        }
        const std::size_t used = read(rest());
        piece.remove_prefix(used < old_size ? joined : used - old_size);
        if (used >= old_size)
          carry_.clear();
        else if (used > 0)
          carry_ = Array<char>(carry_.span().subspan(used));
      }
      retry_size_ = carry_.size() < kEagerRetry ? 0 : carry_.size() + carry_.size() / kRetryGrowth;
      if (carry_.capacity() > share_.amount() && !share_.grow(carry_.capacity() - share_.amount())) return false;
    }
    return true;
  }
  /// Returns the bytes that are not read. They are valid until the next push().
  [[nodiscard]] std::string_view rest() const {
    return carry_.empty() ? std::string_view("") : std::string_view(carry_.data(), carry_.size());
  }

 private:
  void append(std::string_view bytes) {
    if (bytes.empty()) return;
    std::memcpy(carry_.prepare(bytes.size()), bytes.data(), bytes.size());
    carry_.commit(bytes.size());
  }

  // Maximum bytes of an incomplete token that every new piece reads again. A longer token is read again only after
  // 1/kRetryGrowth more was received. Thus a hostile sender of single bytes costs only a bounded multiple of the text.
  static constexpr std::size_t kEagerRetry = 64 * 1024;
  static constexpr std::size_t kRetryGrowth = 8;
  // Maximum bytes of a new piece that are joined to the rest of the previous piece.
  static constexpr std::size_t kJoin = 4096;

  Array<char> carry_;           // grows by moving pages, not bytes
  Share share_;                 // of `carry_`
  std::size_t retry_size_ = 0;  // size of `carry_` at which it is read again
};

}  // namespace gs::vrml
