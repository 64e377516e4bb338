#include "app/script/bounds/block_limit.h"

#include <elf.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

namespace gs::app::script {
namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();
thread_local std::size_t largest_block = kUnlimited;

void* refuse() {
  errno = ENOMEM;
  return nullptr;
}

// Largest sizes of SpiderMonkey's stack for regular expressions. SpiderMonkey aborts if it cannot allocate them.
constexpr std::size_t kStackSizes[] = {std::size_t{1} << 25, std::size_t{1} << 26};

bool is_refused(std::size_t bytes) {
  return bytes > largest_block && bytes != kStackSizes[0] && bytes != kStackSizes[1];
}

void* limited_malloc(std::size_t bytes) { return is_refused(bytes) ? refuse() : std::malloc(bytes); }

void* limited_calloc(std::size_t count, std::size_t bytes) {
  if (bytes != 0 && count > largest_block / bytes) return refuse();
  return std::calloc(count, bytes);
}

void* limited_realloc(void* block, std::size_t bytes) {
  return is_refused(bytes) ? refuse() : std::realloc(block, bytes);
}

std::uintptr_t replacement_of(std::string_view name) {
  if (name == "malloc") return reinterpret_cast<std::uintptr_t>(&limited_malloc);
  if (name == "calloc") return reinterpret_cast<std::uintptr_t>(&limited_calloc);
  if (name == "realloc") return reinterpret_cast<std::uintptr_t>(&limited_realloc);
  return 0;
}

// Reports whether a relocation of this type stores the address of a symbol.
bool stores_address(std::uint64_t type) {
#if defined(__x86_64__)
  return type == R_X86_64_GLOB_DAT || type == R_X86_64_JUMP_SLOT;
#elif defined(__aarch64__)
  return type == R_AARCH64_GLOB_DAT || type == R_AARCH64_JUMP_SLOT;
#else
  (void)type;
  return false;
#endif
}

/// Tables that the dynamic section of a loaded library names.
struct Tables {
  const char* names = nullptr;
  const ElfW(Sym) * symbols = nullptr;
  std::span<const ElfW(Rela)> relocations, calls;
};

Tables tables_of(const dl_phdr_info& library, const ElfW(Dyn) * entry) {
  Tables tables;
  const auto address = [&](const ElfW(Dyn) & one) {
    // glibc's loader has already added the base address to the entry; other loaders have not.
    return one.d_un.d_ptr < library.dlpi_addr ? one.d_un.d_ptr + library.dlpi_addr : one.d_un.d_ptr;
  };
  std::uintptr_t relocations = 0, calls = 0;
  std::size_t relocation_bytes = 0, call_bytes = 0;
  for (; entry->d_tag != DT_NULL; ++entry) {
    if (entry->d_tag == DT_STRTAB) tables.names = reinterpret_cast<const char*>(address(*entry));
    if (entry->d_tag == DT_SYMTAB) tables.symbols = reinterpret_cast<const ElfW(Sym)*>(address(*entry));
    if (entry->d_tag == DT_RELA) relocations = address(*entry);
    if (entry->d_tag == DT_RELASZ) relocation_bytes = entry->d_un.d_val;
    if (entry->d_tag == DT_JMPREL) calls = address(*entry);
    if (entry->d_tag == DT_PLTRELSZ) call_bytes = entry->d_un.d_val;
  }
  using Relocation = ElfW(Rela);
  tables.relocations = {reinterpret_cast<const Relocation*>(relocations), relocation_bytes / sizeof(Relocation)};
  tables.calls = {reinterpret_cast<const Relocation*>(calls), call_bytes / sizeof(Relocation)};
  return tables;
}

// Writes the addresses of the limited functions into the library's global offset table. Returns the number of replaced
// entries.
int redirect(const dl_phdr_info& library, const Tables& tables) {
  int replaced = 0;
  for (const auto relocations : {tables.relocations, tables.calls})
    for (const ElfW(Rela) & one : relocations) {
      if (!stores_address(ELF64_R_TYPE(one.r_info))) continue;
      const std::uintptr_t with = replacement_of(tables.names + tables.symbols[ELF64_R_SYM(one.r_info)].st_name);
      if (with == 0) continue;
      *reinterpret_cast<std::uintptr_t*>(library.dlpi_addr + one.r_offset) = with;
      ++replaced;
    }
  return replaced;
}

int redirect_in_engine(dl_phdr_info* library, std::size_t, void* replaced) {
  if (!std::strstr(library->dlpi_name, "/libmozjs")) return 0;
  const ElfW(Phdr)* dynamic = nullptr;
  const ElfW(Phdr)* read_only = nullptr;
  for (const ElfW(Phdr) & part : std::span(library->dlpi_phdr, library->dlpi_phnum)) {
    if (part.p_type == PT_DYNAMIC) dynamic = &part;
    if (part.p_type == PT_GNU_RELRO) read_only = &part;
  }
  if (!dynamic) return 1;
  const Tables tables = tables_of(*library, reinterpret_cast<const ElfW(Dyn)*>(library->dlpi_addr + dynamic->p_vaddr));
  if (!tables.names || !tables.symbols) return 1;
  // The loader may have made the pages of the table read-only. Make them writable for this change.
  void* first = nullptr;
  std::size_t length = 0;
  if (read_only) {
    const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    const std::uintptr_t begin = (library->dlpi_addr + read_only->p_vaddr) & ~(page - 1);
    const std::uintptr_t end = (library->dlpi_addr + read_only->p_vaddr + read_only->p_memsz) & ~(page - 1);
    first = reinterpret_cast<void*>(begin);
    length = end - begin;
  }
  if (length > 0 && ::mprotect(first, length, PROT_READ | PROT_WRITE) != 0) return 1;
  *static_cast<int*>(replaced) = redirect(*library, tables);
  if (length > 0) (void)::mprotect(first, length, PROT_READ);
  return 1;
}

}  // namespace

BlockLimit::BlockLimit(std::size_t bytes) : before_(std::exchange(largest_block, bytes)) {}
BlockLimit::~BlockLimit() { largest_block = before_; }

bool BlockLimit::install() {
  int replaced = 0;
  (void)dl_iterate_phdr(redirect_in_engine, &replaced);
  return replaced > 0;
}

}  // namespace gs::app::script
