#include "app/script/script_world.h"

#include <cstdint>
#include <limits>
#include <utility>

// Functions of World for calls from programs.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxRequests = 256, kMaxRequestText = std::size_t{32} << 20;

}  // namespace

// Returns the simulated time, which is constant during a function. After kLooks reads in one function, each read adds
// kLook, so that a loop that waits for time to pass ends.
double World::date() {
  constexpr std::uint32_t kLooks = 1000;
  constexpr double kLook = 1e-3;  // seconds
  if (clock_looks_ < std::numeric_limits<std::uint32_t>::max()) ++clock_looks_;
  return execution_.now() + (clock_looks_ > kLooks ? kLook * (clock_looks_ - kLooks) : 0);
}

double World::random() {
  random_ ^= random_ << 13;
  random_ ^= random_ >> 7;
  random_ ^= random_ << 17;
  return static_cast<double>(random_ >> 11) * 0x1.0p-53;
}

void World::print(std::string text) {
  constexpr std::size_t kMaxText = 4096;
  if (text.size() > kMaxText) text.resize(kMaxText);
  tell({{Severity::note, "", {}, std::move(text)}, true});
}

void World::warn_once(std::string text) { report(Severity::warning, *running_, std::move(text)); }

// Adds a request for the session. Drops it if too many requests, or too much text, are already waiting.
void World::request(ScriptRequest request) {
  std::size_t bytes = request.text.size();
  for (const auto* const texts : {&request.urls, &request.parameters})
    for (const std::string& text : *texts) bytes += text.size();
  if (ends_ || running_->ended || requests_.size() >= kMaxRequests || bytes > kMaxRequestText - request_bytes_) return;
  request_bytes_ += bytes;
  requests_.push_back(std::move(request));
}

std::string World::late_message(const Program& program) const {
  const vrml::Node& node = program.scene->node(program.id);
  return Diagnostic{Severity::error, node.text->file_name(), node.location, label(program) + ": " + kLate}.text();
}

}  // namespace gs::app::script
