// python/old_glibc.cpp – a wheel made with a newer glibc is to run with 2.34 (portable/wheel.cmake): its newer symbols.
#include <cstdlib>

extern "C" {
// That of glibc 2.2.5 calls the same function and sets errno in another case, which nothing here reads.
__asm__(".symver hypot_of_old, hypot@GLIBC_2.2.5");
double hypot_of_old(double x, double y);
double __wrap_hypot(double x, double y) { return hypot_of_old(x, y); }

// What libstdc++ asks for random bits, as glibc 2.36 has it.
int getentropy(void* buffer, std::size_t length);  // of glibc 2.25
__attribute__((visibility("hidden"))) unsigned arc4random() {
  unsigned bits = 0;
  if (getentropy(&bits, sizeof bits) != 0) std::abort();
  return bits;
}
}
