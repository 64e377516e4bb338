#pragma once

#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/decode/sample_bricks.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace gs::qnv::values {

/// Number of samples that the inverse lifting of one axis reaches.
inline constexpr std::uint32_t kLiftReach = 4;

/// Returns the window of samples that the inverse lifting of a box needs, in a level of `extent`. Its samples are zeros
/// in `room`, which must outlive the window.
[[nodiscard]] SplitWindow window_around(const SampleBox& box, const Extent& extent, std::vector<std::int32_t>& room);
/// Returns the box of the coarser level that the window needs. Its rows go to every second row of the window, from the
/// first sample on: they are 2 * row apart, and its slices 2 * row * size[1].
[[nodiscard]] SampleBox low_box(const SplitWindow& window);
/// Reverts the lifting of a window. Calls take(y, z, samples) for each row of the box, which window_around() got. The
/// samples of a row are adjacent. Any thread.
void unlift_window(const SplitWindow& window, const SampleBox& box,
                   const std::function<void(std::uint32_t, std::uint32_t, const std::int32_t*)>& take);

}  // namespace gs::qnv::values
