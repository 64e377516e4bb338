#include "net/base/descriptor_limit.h"

#include <algorithm>
#include <limits>

#include <sys/resource.h>

namespace gs::net {

std::size_t raise_descriptor_limit(std::size_t wanted) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return 0;
  const auto size_of = [](rlim_t value) {
    return value == RLIM_INFINITY ? std::numeric_limits<std::size_t>::max() : static_cast<std::size_t>(value);
  };
  if (size_of(limit.rlim_cur) < wanted) {
    rlimit raised = limit;
    raised.rlim_cur = static_cast<rlim_t>(std::min(wanted, size_of(limit.rlim_max)));
    if (::setrlimit(RLIMIT_NOFILE, &raised) == 0) limit = raised;
  }
  return size_of(limit.rlim_cur);
}

}  // namespace gs::net
