#include "app/interface/base/start_layout.h"

#include <catch2/catch.hpp>

namespace gs::app::start_layout_test {

TEST_CASE("places thumbnails inside the viewport, without overlaps") {
  for (const Viewport& place : {Viewport{0, 58, 1024, 700}, {500, 58, 400, 900}, {3, 4, 1920, 300}})
    for (const float scale : {1.0f, 1.5f})
      for (std::size_t count = 0; count < 10; ++count) {
        const StartLayout layout = start_layout(place, count, scale);
        CHECK(layout.thumbnails.size() <= std::min(count, StartLayout::kMax));
        for (std::size_t i = 0; i < layout.thumbnails.size(); ++i) {
          const Viewport& one = layout.thumbnails[i];
          CHECK(one.left >= place.left);
          CHECK(one.top >= place.top);
          CHECK(one.left + one.width <= place.left + place.width);
          CHECK(one.top + one.height <= place.top + place.height);
          for (std::size_t k = 0; k < i; ++k) {
            const Viewport& other = layout.thumbnails[k];
            const bool apart = other.left + other.width <= one.left || other.top + other.height <= one.top;
            CHECK(apart);
          }
        }
      }
  CHECK(start_layout({0, 0, 1024, 768}, 6, 1).thumbnails.size() == 6);
}

TEST_CASE("shows no thumbnails in viewports that are too small") {
  CHECK(start_layout({0, 0, 150, 700}, 6, 1).thumbnails.empty());
  CHECK(start_layout({0, 0, 900, 150}, 6, 1).thumbnails.empty());
  CHECK(start_layout({0, 0, 900, 700}, 0, 1).thumbnails.empty());
}

}  // namespace gs::app::start_layout_test
