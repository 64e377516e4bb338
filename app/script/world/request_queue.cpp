#include "app/script/world/request_queue.h"

namespace gs::app::script {
namespace {

constexpr std::size_t kMaxRequests = 256, kMaxRequestText = std::size_t{32} << 20;

}  // namespace

void RequestQueue::add(ScriptRequest request) {
  std::size_t bytes = request.text.size();
  for (const auto* const texts : {&request.urls, &request.parameters})
    for (const std::string& text : *texts) bytes += text.size();
  if (requests_.size() >= kMaxRequests || bytes > kMaxRequestText - bytes_) return;
  bytes_ += bytes;
  requests_.push_back(std::move(request));
}

void RequestQueue::forget_scene(const vrml::SceneGraph& scene) {
  std::erase_if(requests_, [&](const ScriptRequest& one) { return one.scene == &scene || one.from_scene == &scene; });
}

}  // namespace gs::app::script
