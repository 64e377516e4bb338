#include "render/mesh/draw_pacer.h"

#include <algorithm>
#include <limits>

namespace gs::render {
namespace {

// Pixels of the first slice. In a software rasterizer, drawing that number takes some tenths of a second. Assumes that
// each primitive covers the target.
constexpr std::size_t kFirstPixels = std::size_t{1} << 27;
constexpr std::size_t kLargestSlice = std::size_t{1} << 24;
// Maximum primitives of a slice in a software driver. The driver stores them, some megabytes, before it fills pixels.
constexpr std::size_t kSoftwareSlice = std::size_t{1} << 14;
constexpr GLuint64 kLongestWait = 10'000'000'000;  // nanoseconds; primitives may all be large
constexpr std::chrono::milliseconds kShort{40}, kLong{150};

}  // namespace

DrawPacer::DrawPacer(const Gl& gl, const std::function<bool()>& go_on, std::size_t pixels)
    : gl_(gl),
      go_on_(go_on),
      slice_(go_on         ? std::clamp<std::size_t>(kFirstPixels / std::max<std::size_t>(pixels, 1), 16, 4096)
             : gl.software ? kSoftwareSlice
                           : std::numeric_limits<std::size_t>::max()),
      begin_(Clock::now()) {}

DrawPacer::~DrawPacer() {
  for (const GLsync filled : filled_)
    if (filled) gl_.DeleteSync(filled);
}

void DrawPacer::spend(std::size_t primitives) {
  spent_ += primitives;
  if (spent_ < slice_) return;
  if (!go_on_) {
    GLsync& filled = filled_[oldest_];
    if (filled) {
      (void)gl_.ClientWaitSync(filled, GL_SYNC_FLUSH_COMMANDS_BIT, kLongestWait);
      gl_.DeleteSync(filled);
    }
    filled = gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl_.Flush();
    oldest_ = (oldest_ + 1) % filled_.size();
    spent_ = 0;
    return;
  }
  gl_.Finish();
  const auto now = Clock::now();
  if (now - begin_ < kShort)
    slice_ = std::min(slice_ * 2, kLargestSlice);
  else if (now - begin_ > kLong)
    slice_ = std::max<std::size_t>(slice_ / 4, 1);
  spent_ = 0;
  begin_ = now;
  given_up_ = !go_on_();
}

}  // namespace gs::render
