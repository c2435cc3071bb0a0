// The same header in the oldest C++ that hosts of today use, with one object of every type.
#include <insitu/insitu.h>

int main() {
  insitu_context_desc context;
  insitu_context_desc_init(&context);
  insitu_particles_desc particles;
  insitu_particles_desc_init(&particles);
  const insitu_array array = insitu_array_records(INSITU_F32, 3, nullptr, 0, 0);
  particles.position = &array;
  return context.struct_size == sizeof context && particles.position->count == 0 ? 0 : 1;
}
