#pragma once

#include <cstddef>

namespace gs {

/// Calls `f` with a value of the n-th of the types, or of the last one if `n` is too large.
template <class First, class... Others, class F>
decltype(auto) with_nth_type(std::size_t n, F&& f) {
  if constexpr (sizeof...(Others) > 0)
    if (n > 0) return with_nth_type<Others...>(n - 1, f);
  return f(First{});
}

}  // namespace gs
