#include "app/interface/model/ui_data.h"

namespace gs::app {

VoxelComponent with_dataset(const VoxelComponent& choice, const std::string& path) {
  VoxelComponent other;
  other.dataset = path;
  other.step = choice.step;
  other.folder = choice.folder;
  other.globe = choice.globe;
  other.colors.map = choice.colors.map;
  return other;
}

}  // namespace gs::app
