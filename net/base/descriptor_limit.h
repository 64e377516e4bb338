#pragma once

#include <cstddef>

namespace gs::net {

/// Raises the limit of open descriptors of this process to `wanted`, as far as the system permits. Never lowers it.
/// Returns the resulting limit.
std::size_t raise_descriptor_limit(std::size_t wanted);

}  // namespace gs::net
