#include "render/sorting/depth_order.h"

#include <algorithm>
#include <utility>

namespace gs::render {
namespace {

constexpr std::size_t kMaxOrderedViewports = 16;

SortMethod method_for(const Gl& gl, SortMethod method) {
  if (method != SortMethod::automatic) return method;
  return gl.software ? SortMethod::thread : SortMethod::compute;
}

}  // namespace

DepthOrder::DepthOrder(const Gl& gl, SortMethod method, std::string keys)
    : gl_(gl), wanted_(method_for(gl, method)), keys_(std::move(keys)) {}

DepthOrder::Viewport& DepthOrder::viewport(std::uint32_t number) {
  if (!viewports_.contains(number) && viewports_.size() >= kMaxOrderedViewports)
    viewports_.erase(std::min_element(viewports_.begin(), viewports_.end(),
                                      [](const auto& a, const auto& b) { return a.second.used < b.second.used; }));
  Viewport& found = viewports_[number];
  if (!found.order) found.order = make_buffer(gl_);
  found.used = ++frame_;
  return found;
}

bool DepthOrder::sort_with_compute(std::span<const SortPart> parts, std::size_t total, const DepthGlSort::Data& data,
                                   Viewport& viewport) {
  if (!tried_compute_) {
    tried_compute_ = true;
    compute_ = DepthGlSort::create(gl_, keys_);
  }
  if (!compute_) return false;
  if (!viewport.seen.empty() && DepthSorter::likeness(viewport.seen, parts) == DepthSorter::Likeness::same) return true;
  viewport.number = 0;
  viewport.seen.clear();
  if (!compute_->sort(data, total, viewport.order)) {
    take_errors(gl_);
    compute_ = nullptr;
    return false;
  }
  viewport.seen = DepthSorter::seen_of(parts);
  return true;
}

std::optional<DepthOrder::Result> DepthOrder::order(std::uint32_t number, std::span<const SortPart> parts,
                                                    const DepthGlSort::Data& data) {
  Viewport& own = viewport(number);
  std::size_t total = 0;
  for (const SortPart& part : parts) total += part.count;
  if (wanted_ == SortMethod::compute && sort_with_compute(parts, total, data, own)) {
    sorted_by_ = SortMethod::compute;
    return Result{own.order};
  }
  sorted_by_ = SortMethod::thread;
  own.seen.clear();
  if (!own.sorter) own.sorter = std::make_unique<DepthSorter>();
  const DepthSorter::Order order = own.sorter->order(parts);
  if (order.far_first.size() != total) return std::nullopt;
  const Result result{own.order, !order.exact};
  if (own.number == order.number) return result;
  own.number = order.number;
  gl_.BindBuffer(GL_ARRAY_BUFFER, own.order.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(order.far_first.size_bytes()), order.far_first.data(),
                 GL_STREAM_DRAW);
  if (gl_.GetError() == GL_NO_ERROR) return result;
  own.number = 0;
  return std::nullopt;
}

}  // namespace gs::render
