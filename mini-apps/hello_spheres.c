/* The shortest host: a sunflower of balls that a wave runs through, drawn while it moves. */
#include <insitu/insitu.h>
#include <math.h>
#include <stdio.h>

enum { BALLS = 3000, STEPS = 12 };
struct ball { /* whatever a simulation keeps of a ball; the library reads the fields it is told of where they are */
  double position[3], energy;
  float radius;
} balls[BALLS];

static void move_balls(double time) {
  for (int i = 0; i < BALLS; i++) {
    double distance = sqrt(i + 0.5), angle = 2.399963229728653 * i; /* the golden angle, in radians */
    double height = 5.0 * exp(-0.03 * distance) * sin(0.42 * distance - time);
    balls[i] = (struct ball){
        .position = {distance * cos(angle), distance * sin(angle), height}, .energy = 9.81 * height, .radius = 0.98f};
  }
}

int main(void) {
  insitu_context context;
  if (insitu_context_create(NULL, &context) != INSITU_OK) return fprintf(stderr, "%s\n", insitu_error_text(NULL)), 1;

  /* What there is to see, and how it looks. Every struct starts with its size, and zero means the default. */
  insitu_array position = insitu_array_records(INSITU_F64, 3, balls[0].position, BALLS, sizeof balls[0]);
  insitu_array radius = insitu_array_records(INSITU_F32, 1, &balls[0].radius, BALLS, sizeof balls[0]);
  insitu_array energy = insitu_array_records(INSITU_F64, 1, &balls[0].energy, BALLS, sizeof balls[0]);
  insitu_attribute attribute = {"energy", &energy};
  insitu_particles_desc particles = {sizeof particles, .name = "balls"};
  insitu_geometry geometry;
  insitu_particles_create(context, &particles, &geometry);
  insitu_style style = {sizeof style, INSITU_COLOR_ATTRIBUTE, .attribute = "energy", .colormap = "inferno"};
  insitu_geometry_set_style(context, geometry, &style);

  /* From where, in which light, on how many pixels. */
  insitu_camera camera = {sizeof camera, .eye = {0, -90, 62}, .look_at = {0, -11, -7}, .up = {0, 0, 1},
                          .fov_y_deg = 41};
  insitu_effects effects = {sizeof effects, INSITU_EFFECT_SHADOWS | INSITU_EFFECT_AMBIENT_OCCLUSION, .ao_samples = 8};
  insitu_view_desc view_desc = {sizeof view_desc, .camera = &camera, .effects = &effects,
                                .background = {0.004, 0.004, 0.006, 1}};
  insitu_view view;
  insitu_view_create(context, &view_desc, &view);
  insitu_image_desc image_desc = {sizeof image_desc, .width = 960, .height = 540};
  insitu_image image;
  insitu_image_create(context, &image_desc, &image);

  particles.position = &position, particles.radius = &radius;
  particles.attributes = &attribute, particles.attribute_count = 1;
  for (int step = 0; step < STEPS; step++) {
    move_balls(step * 6.283185307179586 / STEPS);
    insitu_step_begin(context, (uint64_t)step, step);
    insitu_particles_update(context, geometry, &particles); /* lends the arrays to the library until step_end */
    insitu_commit(context);
    insitu_render(context, view, image);
    insitu_image_write(context, image, "hello_{step:3}.png");
    if (insitu_step_end(context) != INSITU_OK) fprintf(stderr, "step %d: %s\n", step, insitu_error_text(context));
  }
  insitu_context_destroy(context);
}
