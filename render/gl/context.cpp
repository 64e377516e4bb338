#include "render/gl/context.h"

#include "render/gl/context_backend.h"

#include <dlfcn.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

namespace gs::render {
namespace {

// Headless backends, in the order in which "auto" tries them.
constexpr std::array kBackends{
    HeadlessBackend{"egl", open_egl_context, false},
    HeadlessBackend{"osmesa", open_osmesa_context, true},
};

// Names, without trailing digits, of entries in /dev that are not GPUs: character devices and folders of the kernel
// (admin-guide/devices.txt) and of virtual machines. GPUs have other names: dri, nvidia0, mali0, kgsl-3d0, dxg,
// pvrsrvkm, nvmap...
constexpr std::array<std::string_view, 70> kOtherDevices{
    "autofs",    "block",       "bsg",     "btrfs-control", "bus",
    "char",      "console",     "core",    "cpu",           "cpu_dma_latency",
    "cuse",      "disk",        "fd",      "full",          "fuse",
    "gpiochip",  "hidraw",      "hpet",    "hugepages",     "hwrng",
    "i2c-",      "input",       "kmsg",    "kvm",           "loop-control",
    "lp",        "mapper",      "mcelog",  "mei",           "mem",
    "mqueue",    "net",         "null",    "nvme",          "nvram",
    "port",      "ppp",         "psaux",   "ptmx",          "ptp",
    "pts",       "random",      "raw",     "rfkill",        "rtc",
    "sev-guest", "sg",          "shm",     "snapshot",      "snd",
    "tdx_guest", "tpm",         "tpmrm",   "tty",           "ttyS",
    "uhid",      "uinput",      "urandom", "usbmon",        "userfaultfd",
    "vcs",       "vcsa",        "vcsu",    "vfio",          "vga_arbiter",
    "vhost-net", "vhost-vsock", "vsock",   "watchdog",      "zero"};

bool is_other_device(std::string_view name) {
  while (!name.empty() && name.back() >= '0' && name.back() <= '9') name.remove_suffix(1);
  return std::find(kOtherDevices.begin(), kOtherDevices.end(), name) != kOtherDevices.end();
}

// Name prefix of the driver's compiler library. Its code runs only while shaders compile.
constexpr std::string_view kCompiler = "libLLVM";

}  // namespace

RuntimeLibrary::RuntimeLibrary(std::initializer_list<const char*> names) {
  for (const char* name : names) {
    handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (handle_) return;
    const char* reason = dlerror();
    error_ = reason ? reason : name;
  }
}

void* RuntimeLibrary::symbol(const char* name) const { return handle_ ? dlsym(handle_, name) : nullptr; }

bool is_software_renderer(std::string_view renderer) {
  std::string name(renderer);
  for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  constexpr std::array<std::string_view, 5> kWords{"llvmpipe", "softpipe", "swrast", "software", "swiftshader"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return name.find(word) != std::string::npos; });
}

bool may_have_gpu(const std::filesystem::path& devices) {
  std::error_code error;
  std::filesystem::directory_iterator entry(devices, error);
  if (error) return true;
  for (; entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (error) return true;
    std::error_code unknown;
    const std::filesystem::file_type type = entry->symlink_status(unknown).type();
    const bool device = type != std::filesystem::file_type::block && type != std::filesystem::file_type::symlink &&
                        type != std::filesystem::file_type::socket && type != std::filesystem::file_type::fifo;
    if (device && !is_other_device(entry->path().filename().native())) return true;
  }
  return false;
}

void release_driver_code() {
  const auto release = [](dl_phdr_info* library, std::size_t, void*) {
    const std::string_view path = library->dlpi_name;
    if (path.substr(path.rfind('/') + 1).substr(0, kCompiler.size()) != kCompiler) return 0;
    const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    for (const auto& part : std::span(library->dlpi_phdr, library->dlpi_phnum)) {
      // Skip pages that are or were writable: their contents differ from the file.
      if (part.p_type != PT_LOAD || (part.p_flags & PF_W) != 0) continue;
      const std::uintptr_t begin = (library->dlpi_addr + part.p_vaddr) / page * page;
      const std::uintptr_t end = library->dlpi_addr + part.p_vaddr + part.p_filesz;
      (void)::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
    }
    return 0;
  };
  (void)::dl_iterate_phdr(release, nullptr);
}

std::variant<std::unique_ptr<GlContext>, ContextError> open_headless_context(std::string_view backend) {
  const bool automatic = backend == "auto";
  std::string tried, names = "auto";
  for (const HeadlessBackend& row : kBackends) {
    names.append(", ").append(row.name);
    if (!automatic && row.name != backend) continue;
    OpenedContext opened = row.open(automatic && !row.software);
    if (std::holds_alternative<std::unique_ptr<GlContext>>(opened)) return opened;
    if (!tried.empty()) tried += "; ";
    tried.append(row.name).append(": ").append(std::get<ContextError>(opened).message);
  }
  if (tried.empty()) return ContextError{"no backend '" + std::string(backend) + "': expected one of " + names};
  return ContextError{"cannot open an OpenGL 3.3 context (" + tried + ")"};
}

std::vector<std::string_view> headless_backends() {
  std::vector<std::string_view> names;
  for (const HeadlessBackend& row : kBackends) names.push_back(row.name);
  return names;
}

}  // namespace gs::render
