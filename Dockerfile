# The tools and the viewer on Debian 13, without root and on a read-only file system:
#   docker build -t stratum .
#   docker run --rm --read-only -v "$PWD:/prints" stratum gcode2vdb part.gcode -o part.vdb
#   docker run --rm --read-only -v "$PWD:/prints:ro" -p 127.0.0.1:8080:8080 stratum
# The last one shows all .gcode files of the folder in the browser, at the URL that it prints.
FROM debian:13 AS build
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates dpkg-dev file
COPY . /stratum
WORKDIR /stratum
RUN bash scripts/demo.sh && cmake --build build/release --target package && mkdir /packages && mv build/release/*.deb /packages/

FROM debian:13-slim
COPY --from=build /packages/stratum_*.deb /packages/stratum-viewer_*.deb /packages/
RUN apt-get update && apt-get install -y --no-install-recommends /packages/*.deb && rm -rf /packages /var/lib/apt/lists/*
USER 1000:1000
WORKDIR /prints
EXPOSE 8080
CMD ["sh", "-c", "exec vdbview --listen 0.0.0.0 --port 8080 *.gcode"]
