#include "app/commands/common/picture_memory.h"

#include "vrml/scene/scene_graph.h"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <variant>

namespace gs::app {
namespace {

bool addresses_are_limited() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY;
}

/// Returns true in a virtual machine that returns free large pages to its host (virtio balloon with "free page
/// reporting"). Using such a page again takes milliseconds.
bool host_takes_pages_back() {
  constexpr std::size_t kReporting = 5;  // bit of VIRTIO_BALLOON_F_REPORTING; `features` is a text of 0 and 1
  std::error_code error;
  for (const auto& device : std::filesystem::directory_iterator("/sys/bus/virtio/devices", error)) {
    std::string kind, features;
    std::ifstream(device.path() / "device") >> kind;
    std::ifstream(device.path() / "features") >> features;
    if (kind == "0x0005" && features.size() > kReporting && features[kReporting] == '1') return true;
  }
  return false;
}

std::uintptr_t end_of_heap() { return reinterpret_cast<std::uintptr_t>(::sbrk(0)); }

}  // namespace

void keep_memory() {
  constexpr int kMapped = 32 << 20;     // min size of a block that gets a separate mapping, in bytes
  constexpr int kKept = 1 << 30;        // max amount of free memory that the heap keeps, in bytes
  constexpr int kAhead = 16 << 20;      // bytes by which the heap grows at a time
  constexpr int kReserved = 512 << 20;  // bytes of address space to reserve; writing to a page takes memory
  constexpr std::uintptr_t kLargePage = 2 << 20;
  (void)mallopt(M_MMAP_THRESHOLD, kMapped);
  (void)mallopt(M_TRIM_THRESHOLD, kKept);
  if (!addresses_are_limited() && !host_takes_pages_back()) {
    (void)mallopt(M_ARENA_MAX, 1);
    const std::uintptr_t before = end_of_heap();
    (void)mallopt(M_TOP_PAD, kReserved);
    void* volatile block = std::malloc(kMapped / 2);  // volatile, or the compiler could remove both calls
    std::free(block);
    const std::uintptr_t first = (before + kLargePage - 1) / kLargePage * kLargePage;
    const std::uintptr_t last = end_of_heap() / kLargePage * kLargePage;
    if (first < last) (void)::madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
  }
  (void)mallopt(M_TOP_PAD, kAhead);
}

void release_lists(vrml::SceneGraph& scene) {
  constexpr std::size_t kLarge = 100'000;  // number of elements
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    if (!scene.contains(scene.nodes().id_at(i))) continue;
    vrml::Node& node = scene.node(scene.nodes().id_at(i));
    for (std::size_t slot = 0; slot < node.type->defaults.size(); ++slot)
      std::visit(
          [](auto& value) {
            if constexpr (requires { value.shared(); })
              if (value.size() > kLarge) value = {};
          },
          node.values[slot]);
  }
  for (const auto& [inline_node, content] : scene.inlines().all())
    if (content) release_lists(*content);
}

}  // namespace gs::app
