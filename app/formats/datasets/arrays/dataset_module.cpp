#include "app/formats/datasets/arrays/dataset_module.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <dlfcn.h>

namespace gs::app {
namespace {

constexpr const char* kModuleFile = "ghostspace-datasets.so";

using LoadedModule = std::variant<const DatasetModule*, std::string>;

LoadedModule load_module_at(const std::string& path) {
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!handle) {
    const char* const why = ::dlerror();
    return "the module for scientific formats cannot be loaded: " + std::string(why ? why : path);
  }
  const auto entry = reinterpret_cast<DatasetModuleEntry>(::dlsym(handle, kDatasetModuleEntry));
  const DatasetModule* const module = entry ? entry() : nullptr;
  if (!module || module->version != DatasetModule::kVersion) return path + " belongs to another version of the program";
  return module;
}

LoadedModule load_module() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return std::string("the folder of the program is unknown");
  for (const char* const folder : {"../lib/ghostspace", "lib/ghostspace"}) {
    const auto path = program.parent_path() / folder / kModuleFile;
    if (std::filesystem::exists(path, error)) return load_module_at(path.string());
  }
  return "the module for scientific formats is missing; expected " +
         (program.parent_path().parent_path() / "lib/ghostspace" / kModuleFile).string();
}

}  // namespace

LoadedModule dataset_module() {
  static const LoadedModule module = load_module();
  return module;
}

ArrayFileResult open_with_module(std::string_view reader, const SharedBytes& content, std::size_t cache_bytes) {
  const LoadedModule module = dataset_module();
  if (const auto* const problem = std::get_if<std::string>(&module)) return *problem;
  const auto readers = std::get<const DatasetModule*>(module)->readers;
  const auto row = std::ranges::find(readers, reader, &ArrayReader::name);
  if (row == readers.end()) return "the module for scientific formats has no reader of " + std::string(reader);
  return row->open({content.owner, content.bytes, content.need}, cache_bytes);
}

}  // namespace gs::app
