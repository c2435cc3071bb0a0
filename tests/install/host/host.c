/* The least a host does: shows that header, library and loader found each other. */
#include <insitu/insitu.h>
#include <stdio.h>

int main(void) {
  insitu_context context = NULL;
  if (insitu_abi_version() != INSITU_ABI) return 1;
  if (insitu_context_create(NULL, &context) != INSITU_OK) {
    fprintf(stderr, "%s\n", insitu_error_text(NULL));
    return 1;
  }
  insitu_context_destroy(context);
  printf("insitu %s\n", insitu_version_text());
  return 0;
}
