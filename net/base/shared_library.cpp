#include "net/base/shared_library.h"

#include <dlfcn.h>

namespace gs::net {

SharedLibrary::SharedLibrary(const char* name) : name_(name), handle_(dlopen(name, RTLD_NOW | RTLD_LOCAL)) {
  if (!handle_) problem_ = name_ + " cannot be opened; install it";
}

void* SharedLibrary::symbol(const char* name) {
  if (!handle_) return nullptr;
  void* const found = dlsym(handle_, name);
  if (!found && problem_.empty()) problem_ = name_ + " has no " + name;
  return found;
}

}  // namespace gs::net
