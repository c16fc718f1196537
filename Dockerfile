# The program alone, on Debian:
#   docker build -t flowcage . && docker run --rm -v "$PWD:/case" flowcage mesh wing.step --levels 2 -o case
FROM debian:12 AS build
COPY . /flowcage
WORKDIR /flowcage
RUN ./install-packages.sh build && apt-get install -y --no-install-recommends dpkg-dev file \
 && cmake --preset release -DFLOWCAGE_TESTS=OFF && cmake --build --preset release && cpack --config build/release/CPackConfig.cmake -B /package

FROM debian:12-slim
COPY --from=build /package/*.deb /tmp/
RUN apt-get update && apt-get install -y --no-install-recommends /tmp/*.deb && rm -rf /tmp/*.deb /var/lib/apt/lists/*
WORKDIR /case
ENTRYPOINT ["flowcage"]
