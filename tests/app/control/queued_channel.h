#pragma once

#include "app/control/control.h"

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

namespace gs::app {

/// Channel without sockets, with prepared events, for tests, fuzz targets and benchmarks.
class QueuedChannel : public ControlChannel {
 public:
  [[nodiscard]] std::optional<net::ControlNews> next() override {
    if (news.empty()) return std::nullopt;
    net::ControlNews one = std::move(news.front());
    news.pop_front();
    return one;
  }
  [[nodiscard]] bool is_behind(std::uint64_t) const override { return false; }

  std::deque<net::ControlNews> news;
};

}  // namespace gs::app
