/* The least a host does: shows that header, library and loader found each other, and that files can be written. */
#include <insitu/insitu.h>
#include <stdio.h>

int main(void) {
  insitu_context context = NULL;
  insitu_image_desc desc;
  insitu_image image;
  insitu_view view;
  if (insitu_abi_version() != INSITU_ABI) return 1;
  if (insitu_context_create(NULL, &context) != INSITU_OK) {
    fprintf(stderr, "%s\n", insitu_error_text(NULL));
    return 1;
  }
  insitu_image_desc_init(&desc);
  desc.width = desc.height = 8;
  insitu_image_create(context, &desc, &image);
  insitu_view_create(context, NULL, &view);
  insitu_step_begin(context, 0, 0.0);
  insitu_commit(context);
  insitu_render(context, view, image);
  insitu_image_write(context, image, "host.png");
  if (insitu_step_end(context) != INSITU_OK) {
    fprintf(stderr, "%s\n", insitu_error_text(context));
    return 2;
  }
  insitu_context_destroy(context);
  printf("insitu %s\n", insitu_version_text());
  return 0;
}
